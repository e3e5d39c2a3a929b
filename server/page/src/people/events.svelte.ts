// What webhooks and e-mail can be told of, and of which projects.
import { getJson } from "../api/client";
import { me } from "../api/me.svelte";
import type { Page, Project, WebhookEvent } from "../api/types";

export const EVENTS: Record<WebhookEvent, string> = {
  ended: "a job has ended",
  failed: "one has failed",
  quarantined: "one was set aside",
  shared: "something was shared",
  quota: "my files or queued jobs come near their limit",
};

/** Projects that are one's own or one's group's, once they are there. */
export function heldProjects(): { readonly all: Project[] } {
  let projects = $state.raw<Project[]>([]);
  const held = $derived.by(() => {
    const groups = (me.caller?.groups ?? []).map(({ id }) => id);
    const isHeld = ({ person, group }: Project): boolean =>
      person?.id === me.caller?.person?.id || groups.includes(group?.id ?? "");
    return projects.filter(isHeld);
  });
  // Without them there is still the choice of all one's jobs.
  getJson<Page<Project>>("/v1/projects").then(
    (page) => (projects = page.items),
    () => {},
  );
  return {
    get all() {
      return held;
    },
  };
}
