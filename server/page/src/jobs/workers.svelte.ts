// The workers, as the server knows them.
import { getJson } from "../api/client";
import type { Page, Worker } from "../api/types";

/** A worker says nothing to the page by itself; its lease is 30 s, so this often [ms] is enough. */
const POLL = 15_000;
const SOON = 600;

export class Workers {
  items = $state.raw<Worker[] | null>(null);
  #soon: ReturnType<typeof setTimeout> | undefined;

  async load(): Promise<void> {
    try {
      this.items = (await getJson<Page<Worker>>("/v1/workers")).items;
    } catch {
      // The list of jobs reports that the server is away.
    }
  }

  refreshSoon(): void {
    this.#soon ??= setTimeout(() => {
      this.#soon = undefined;
      void this.load();
    }, SOON);
  }

  watch(): () => void {
    const timer = setInterval(() => document.hidden || void this.load(), POLL);
    return () => {
      clearInterval(timer);
      clearTimeout(this.#soon);
    };
  }
}
