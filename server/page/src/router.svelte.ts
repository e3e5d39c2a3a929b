// Where in the page the person is. Links are plain links; clicks on them are taken over here.
import { tick } from "svelte";

export type Route =
  | { view: "jobs"; query: URLSearchParams }
  | { view: "job"; id: string }
  | { view: "submit"; query: URLSearchParams }
  | { view: "compare"; id: string | null; query: URLSearchParams }
  | { view: "account" }
  | { view: "people" }
  | { view: "trash" }
  | { view: "invitation" }
  | { view: "mail" }
  | { view: "shared" }
  | { view: "refused"; query: URLSearchParams }
  | { view: "unknown" };

export const router = $state({ route: read() });

function read(): Route {
  const { pathname, search } = window.location;
  const query = new URLSearchParams(search);
  const [first, id, ...more] = pathname.split("/").filter(Boolean);
  if (first === undefined || (first === "jobs" && id === undefined)) return { view: "jobs", query };
  if (first === "jobs" && id !== undefined && more.length === 0) return { view: "job", id };
  if (first === "compare" && more.length === 0) return { view: "compare", id: id ?? null, query };
  if (first === "submit" && id === undefined) return { view: "submit", query };
  if (id === undefined && (first === "account" || first === "people" || first === "trash" || first === "mail"))
    return { view: first };
  if (id === undefined && (first === "invitation" || first === "shared")) return { view: first };
  if (id === undefined && first === "sign-in") return { view: "refused", query };
  return { view: "unknown" };
}

/** Goes to an address of the page and moves the focus to its heading, as a page load would. */
export async function navigate(href: string): Promise<void> {
  history.pushState(null, "", href);
  router.route = read();
  window.scrollTo(0, 0);
  await tick();
  document.querySelector<HTMLElement>("main h1")?.focus({ preventScroll: true });
}

/** Keeps the address in step with a view's own state, without a new entry in the history. */
export function replaceQuery(query: URLSearchParams): void {
  const text = query.toString();
  history.replaceState(null, "", window.location.pathname + (text ? `?${text}` : ""));
}

const SERVED = /^\/(v1|guide|docs|openapi\.json|version|healthz|readyz|metrics|licenses\.md|assets)(\/|$)/;

/** Takes over clicks on links within the page; those to the server's own answers stay. */
export function takeOverLinks(): () => void {
  const onClick = (event: MouseEvent): void => {
    if (event.defaultPrevented || event.button !== 0) return;
    if (event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return;
    const link = (event.target as Element | null)?.closest?.("a");
    if (!link || link.target || link.hasAttribute("download")) return;
    const isWithin = link.origin === window.location.origin && !SERVED.test(link.pathname);
    if (!isWithin || link.getAttribute("href")?.startsWith("#")) return;
    event.preventDefault();
    void navigate(link.href);
  };
  const onBack = (): void => {
    router.route = read();
  };
  document.addEventListener("click", onClick);
  window.addEventListener("popstate", onBack);
  return () => {
    document.removeEventListener("click", onClick);
    window.removeEventListener("popstate", onBack);
  };
}
