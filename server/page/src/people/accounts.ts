// What people do with their account, as the server takes it.
import { complaintsOf, Refusal, request } from "../api/client";

/** Signs in by name and password; returns what is wrong, or nothing. */
export async function signIn(name: string, password: string): Promise<string> {
  try {
    await request("/v1/sessions", { method: "POST", body: JSON.stringify({ name, password }) });
    return "";
  } catch (error) {
    if (error instanceof Refusal && error.problem.type === "/problems/wrong-password") {
      return "Name or password is wrong.";
    }
    return complaintsOf(error).join(" ");
  }
}

/** The secret behind `#` of the address; it never travels to the server with the page. */
export function secretOfAddress(): string {
  return window.location.hash.slice(1);
}

/** The address to give somebody for a path of the page. */
export function addressOf(path: string): string {
  return window.location.origin + path;
}
