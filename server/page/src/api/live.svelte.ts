// Following the server's events, and whether the page still hears it.
import { Refusal, request } from "./client";
import { EventReader, jobEvent } from "./sse";
import type { JobEvent } from "./types";

export const connection = $state({ isLost: false, retryAt: 0 });

/** First wait before opening the stream again [ms]. */
const FIRST_WAIT = 500;
/** Longest wait between two tries [ms]: a page left open overnight is back within this. */
const LONGEST_WAIT = 15_000;
/** A hidden page gives up its stream after this [ms], because browsers allow only six connections
 * to a server and a lab leaves more tabs open than that. */
const HIDDEN_GRACE = 20_000;
/** A stream silent for this long [ms] is taken for dead: after a night's sleep a computer may hold a
 * connection that nobody else does. The server sends a sign of life every 15 s. */
const LONGEST_SILENCE = 45_000;
/** How often a hidden page looks instead [ms], so that its title stays true. */
const HIDDEN_POLL = 20_000;

export interface Follower {
  event(event: JobEvent): void;
  /** Events may have been missed: fetch everything again. */
  refresh(): void;
}

let wakeUp = (): void => {};

/** Tries again at once. */
export function reconnectNow(): void {
  wakeUp();
}

/** Follows the events at `path` until the returned function is called. */
export function follow(path: string, follower: Follower): () => void {
  const stopped = new AbortController();
  void run(path, follower, stopped.signal);
  return () => stopped.abort();
}

type Ending = "ended" | "failed" | "refused" | "hidden" | "silent";

async function run(path: string, follower: Follower, stopped: AbortSignal): Promise<void> {
  let wait = FIRST_WAIT;
  while (!stopped.aborted) {
    const ending = await listen(path, follower, stopped);
    if (stopped.aborted || ending === "refused") break;
    if (ending === "hidden") {
      while (document.hidden && !stopped.aborted) {
        await sleep(HIDDEN_POLL, stopped);
        follower.refresh();
      }
      continue;
    }
    // A stream that ends is opened again at once; only silence after that is a lost server.
    wait = ending === "ended" || ending === "silent" ? FIRST_WAIT : Math.min(wait * 2, LONGEST_WAIT);
    if (ending === "failed") {
      connection.isLost = true;
      connection.retryAt = Date.now() + wait;
    }
    await sleep(wait, stopped);
  }
  connection.isLost = false;
}

async function listen(path: string, follower: Follower, stopped: AbortSignal): Promise<Ending> {
  const given = new AbortController();
  const giveUp = (why: Ending): void => given.abort(why);
  const stopWatching = watchVisibility(() => giveUp("hidden"));
  let silence = setTimeout(giveUp, LONGEST_SILENCE, "silent");
  let isOpen = false;
  try {
    const response = await request(path, {
      headers: { Accept: "text/event-stream" },
      signal: AbortSignal.any([stopped, given.signal]),
    });
    if (!response.body) return "failed";
    isOpen = true;
    connection.isLost = false;
    // Only now: what changes after this moment comes as an event, what was before is fetched.
    follower.refresh();
    const text = response.body.pipeThrough(new TextDecoderStream()).getReader();
    const reader = new EventReader();
    for (;;) {
      const { done, value } = await text.read();
      if (done) return "ended";
      clearTimeout(silence);
      silence = setTimeout(giveUp, LONGEST_SILENCE, "silent");
      for (const event of reader.read(value)) follower.event(jobEvent(event));
    }
  } catch (error) {
    if (stopped.aborted) return "ended";
    if (given.signal.aborted) return given.signal.reason as Ending;
    if (error instanceof Refusal && error.status < 500) {
      // The fetch of the thing itself meets the same refusal and shows it where people look.
      follower.refresh();
      return "refused";
    }
    return isOpen ? "ended" : "failed";
  } finally {
    clearTimeout(silence);
    stopWatching();
  }
}

/** Reports once the page has been hidden for the grace time; returns how to stop watching. */
function watchVisibility(onHidden: () => void): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const watch = (): void => {
    clearTimeout(timer);
    if (document.hidden) timer = setTimeout(onHidden, HIDDEN_GRACE);
  };
  watch();
  document.addEventListener("visibilitychange", watch);
  return () => {
    clearTimeout(timer);
    document.removeEventListener("visibilitychange", watch);
  };
}

/** Sleeps until stopped, woken by hand, the page becomes visible, or the network comes back. */
function sleep(milliseconds: number, stopped: AbortSignal): Promise<void> {
  return new Promise((resolve) => {
    const awake = new AbortController();
    const finish = (): void => {
      clearTimeout(timer);
      awake.abort();
      resolve();
    };
    const timer = setTimeout(finish, milliseconds);
    wakeUp = finish;
    const { signal } = awake;
    document.addEventListener("visibilitychange", () => document.hidden || finish(), { signal });
    window.addEventListener("online", finish, { signal });
    stopped.addEventListener("abort", finish, { signal });
  });
}
