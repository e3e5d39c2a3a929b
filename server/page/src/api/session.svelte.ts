// The access token of this browser, and the question for it.
//
// A server on loopback without tokens never asks. Otherwise the first 401 opens one dialog, and
// every request that met it waits for the same answer.

const KEY = "loadframe-token";

export const session = $state({
  token: sessionStorage.getItem(KEY) ?? localStorage.getItem(KEY),
  isAsking: false,
  wasRejected: false,
});

let waiting: (() => void)[] = [];

/** Resolves once the person has given a token; `rejected` is the one the server refused. */
export function askForToken(rejected: string | null): Promise<void> {
  // Another request may have been answered while this one was under way.
  if (session.token !== rejected) return Promise.resolve();
  session.wasRejected = rejected !== null;
  session.isAsking = true;
  return new Promise((resolve) => waiting.push(resolve));
}

/** Takes the token; it outlives the tab only when `remember` is set. */
export function giveToken(token: string, remember: boolean): void {
  forgetToken();
  sessionStorage.setItem(KEY, token);
  if (remember) localStorage.setItem(KEY, token);
  session.token = token;
  session.isAsking = false;
  const resolved = waiting;
  waiting = [];
  for (const resolve of resolved) resolve();
}

export function forgetToken(): void {
  sessionStorage.removeItem(KEY);
  localStorage.removeItem(KEY);
  session.token = null;
}
