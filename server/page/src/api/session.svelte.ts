// How this browser is known to the server, and the question for it.
//
// A server on loopback without people never asks. Otherwise the first 401 opens one dialog, and every
// request that met it waits for the same answer: a token, or, where the server has people, a name and
// a password, after which a cookie that no script sees goes with every request. Whoever comes by a
// share link is known by the link's secret, in this tab and only until it closes.

const KEY = "loadframe-token";
const LINK = "loadframe-link";

export type Question = "token" | "sign-in";

export const session = $state({
  token: sessionStorage.getItem(LINK) ?? sessionStorage.getItem(KEY) ?? localStorage.getItem(KEY),
  /** Whether the token is the secret of a share link. */
  isLink: sessionStorage.getItem(LINK) !== null,
  asking: null as Question | null,
  wasRejected: false,
});

let waiting: (() => void)[] = [];
/** Counts ways in that were given. */
let given = 0;

/** How often something was given; a request that was refused since may simply be sent again. */
export function timesGiven(): number {
  return given;
}

/** Resolves once the person has given what the server asks for; `before` is `timesGiven` of the request. */
export function ask(question: Question, before: number): Promise<void> {
  // Another request may have been answered while this one was under way.
  if (given !== before) return Promise.resolve();
  session.wasRejected = session.token !== null;
  session.asking = question;
  return new Promise((resolve) => waiting.push(resolve));
}

/** Takes the token; it outlives the tab only when `remember` is set. */
export function giveToken(token: string, remember: boolean): void {
  forgetToken();
  sessionStorage.setItem(KEY, token);
  if (remember) localStorage.setItem(KEY, token);
  session.token = token;
  goOn();
}

/** Takes the secret of a share link, for this tab. */
export function giveLink(secret: string): void {
  sessionStorage.setItem(LINK, secret);
  session.token = secret;
  session.isLink = true;
  goOn();
}

/** The person has signed in: from now on the cookie says who asks. */
export function signedIn(): void {
  forgetToken();
  goOn();
}

function goOn(): void {
  given += 1;
  session.asking = null;
  const resolved = waiting;
  waiting = [];
  for (const resolve of resolved) resolve();
}

/** Forgets the link, if there is one, and else the token. */
export function forgetToken(): void {
  const wasLink = session.isLink;
  sessionStorage.removeItem(LINK);
  session.isLink = false;
  if (!wasLink) {
    sessionStorage.removeItem(KEY);
    localStorage.removeItem(KEY);
  }
  session.token = wasLink ? (sessionStorage.getItem(KEY) ?? localStorage.getItem(KEY)) : null;
}
