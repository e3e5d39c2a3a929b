// Who the server takes this browser for: what the page shows depends on it, what is allowed does not.
import { getJson, request } from "./client";
import { forgetToken } from "./session.svelte";
import type { Caller } from "./types";

export const me = $state({ caller: null as Caller | null });

/** Asks the server; the dialog opens first where it wants to know. */
export async function meet(): Promise<Caller> {
  const caller = await getJson<Caller>("/v1/me");
  me.caller = caller;
  return caller;
}

/** Whether the server has accounts and this is somebody's. */
export function isPerson(): boolean {
  return me.caller?.kind === "person";
}

export function isAdministrator(): boolean {
  return me.caller?.person?.role === "administrator" && me.caller.scope === null;
}

/** Whether there is any use in showing what changes jobs. */
export function mayChange(): boolean {
  const caller = me.caller;
  if (caller === null) return true;
  const changes = caller.scope === null || caller.scope === "submit" || caller.scope === "everything";
  return caller.kind !== "share" && changes && caller.person?.role !== "guest";
}

/** Ends the session or forgets the token, and begins anew. */
export async function signOut(): Promise<void> {
  if (isPerson() && me.caller?.scope === null) await request("/v1/sessions/current", { method: "DELETE" });
  forgetToken();
  window.location.assign("/");
}
