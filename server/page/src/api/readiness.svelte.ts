// Whether the server takes what is sent to it: a full disk is told to everybody who looks.
import type { Problem } from "./types";

/** How often to ask [ms]. */
const POLL = 10_000;

export const readiness = $state({
  /** What the server says is wrong, empty while all is well. */
  trouble: "",
});

async function look(): Promise<void> {
  try {
    const answer = await fetch("/readyz", { headers: { Accept: "application/json" } });
    readiness.trouble = answer.status === 503 ? ((await answer.json()) as Problem).detail : "";
  } catch {
    // That the server is away is told by the event stream.
    readiness.trouble = "";
  }
}

export function watchReadiness(): () => void {
  void look();
  const timer = setInterval(() => document.hidden || void look(), POLL);
  return () => clearInterval(timer);
}
