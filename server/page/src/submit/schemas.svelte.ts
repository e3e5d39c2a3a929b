// The schemas of specs, each asked for once.
import { getJson } from "../api/client";
import type { Schema } from "./json/schema";

export class Schemas {
  #known = $state.raw<Record<string, Schema>>({});
  // eslint-disable-next-line svelte/prefer-svelte-reactivity -- read by nothing that is shown
  readonly #asked = new Set<string>();

  /** The schema of a kind's spec, as soon as it has arrived. */
  of(kind: string): Schema | null {
    return this.#known[kind] ?? null;
  }

  ask(kind: string): void {
    if (kind === "" || this.#asked.has(kind)) return;
    this.#asked.add(kind);
    getJson<Schema>(`/v1/kinds/${encodeURIComponent(kind)}/schema`).then(
      (schema) => (this.#known = { ...this.#known, [kind]: schema }),
      // Asked again when it is next needed, after a failure of the network.
      () => this.#asked.delete(kind),
    );
  }
}
