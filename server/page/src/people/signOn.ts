// Single sign-on: the ways in that the server offers, and the way to a provider.
import { request } from "../api/client";
import type { SignInBegun, SignInWays } from "../api/types";

/** Why somebody came back from the provider without being signed in, by the server's words. */
const REASONS: Record<string, string> = {
  not_admitted: "You have no account on this server and are not invited. Ask one of its administrators.",
  taken: "That account of the provider belongs to somebody else here.",
  denied: "The provider did not sign you in.",
  ended: "That sign-in was begun in another browser or too long ago. Begin again.",
  provider:
    "The provider could not be asked, or its answer was not to be believed. An administrator finds more in the log.",
};

export function reasonOf(word: string): string {
  return REASONS[word] ?? "You are not signed in.";
}

/** The name of the provider, if there is one. Asked without the dialog that this is shown in. */
export async function provider(): Promise<string | null> {
  const answer = await fetch("/v1/sign-in", { cache: "no-cache" }).catch(() => null);
  if (!answer?.ok) return null;
  return ((await answer.json()) as SignInWays).provider;
}

/** Leaves the page for the provider's. */
export async function signOn(): Promise<void> {
  const answer = await request("/v1/sign-in/provider", { method: "POST" });
  window.location.assign(((await answer.json()) as SignInBegun).address);
}
