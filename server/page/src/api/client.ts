// Requests to the server: who asks, errors as problems, the server's clock.
import { setServerTime } from "../clock.svelte";
import { sentence } from "../format/words";
import { ask, session, timesGiven } from "./session.svelte";
import type { Problem, Violation } from "./types";

/** An answer that says no, with what the server says about it. */
export class Refusal extends Error {
  readonly problem: Problem;

  constructor(problem: Problem) {
    super(problem.detail || problem.title);
    this.problem = problem;
  }

  get status(): number {
    return this.problem.status;
  }

  get violations(): Violation[] {
    return this.problem.violations ?? [];
  }
}

/** No answer at all: the server is down or the network is. */
export class Unreachable extends Error {
  constructor() {
    super("The server does not answer.");
  }
}

/** What to tell a person about something that went wrong. */
export function messageOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

/** The same in one line for each thing that is wrong, if the server found several. */
export function complaintsOf(error: unknown): string[] {
  const violations = error instanceof Refusal ? error.violations : [];
  if (violations.length === 0) return [messageOf(error)];
  return violations.map(({ pointer, detail, allowed, value }) => {
    // Of a list, which one.
    const which = /\/\d+$/.test(pointer) ? `“${String(value)}”: ` : "";
    return `${which}${sentence(detail)}${allowed ? ` Allowed: ${allowed}.` : ""}`;
  });
}

export interface RequestOptions {
  method?: string;
  /** Sent as it is, as JSON. */
  body?: string;
  headers?: Record<string, string>;
  signal?: AbortSignal;
}

/** Sends a request and returns its successful answer; asks the person in when that is needed. */
export async function request(path: string, options: RequestOptions = {}): Promise<Response> {
  for (;;) {
    const token = session.token;
    const before = timesGiven();
    const headers: Record<string, string> = { Accept: "application/json", ...options.headers };
    if (token) headers["Authorization"] = `Bearer ${token}`;
    if (options.body !== undefined) headers["Content-Type"] = "application/json";
    let response: Response;
    try {
      // Ask again each time: the server answers 304 when nothing has changed.
      response = await fetch(path, { cache: "no-cache", ...options, headers });
    } catch (error) {
      if (options.signal?.aborted) throw error;
      throw new Unreachable();
    }
    setServerTime(response.headers.get("Date"));
    if (response.ok) return response;
    const problem = await readProblem(response);
    // A link that has ended is not mended by signing in.
    if (response.status !== 401 || session.isLink) throw new Refusal(problem);
    await ask(problem.type === "/problems/sign-in-needed" ? "sign-in" : "token", before);
  }
}

export async function getJson<T>(path: string, signal?: AbortSignal): Promise<T> {
  const response = await request(path, signal ? { signal } : {});
  return (await response.json()) as T;
}

export async function sendJson<T>(method: string, path: string, body?: unknown): Promise<T> {
  const options: RequestOptions = { method };
  if (body !== undefined) options.body = JSON.stringify(body);
  return (await (await request(path, options)).json()) as T;
}

async function readProblem(response: Response): Promise<Problem> {
  const fallback = { type: "about:blank", title: response.statusText, status: response.status };
  try {
    return { detail: "", ...fallback, ...((await response.json()) as Partial<Problem>) };
  } catch {
    // A proxy in between answers in HTML.
    return { ...fallback, detail: `The server answered ${response.status}.` };
  }
}
