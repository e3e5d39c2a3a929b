// The workers, as the server knows them.
import { getJson } from "../api/client";
import type { Page, ReportedAllocations, Worker } from "../api/types";

/** A worker says nothing to the page by itself; its lease is 30 s, so this often [ms] is enough. */
const POLL = 15_000;
const SOON = 600;

export class Workers {
  items = $state.raw<Worker[] | null>(null);
  /** What batch systems give to workers, where somebody asks them for machines. */
  allocations = $state.raw<ReportedAllocations[]>([]);
  #soon: ReturnType<typeof setTimeout> | undefined;

  async load(): Promise<void> {
    try {
      const [workers, allocations] = await Promise.all([
        getJson<Page<Worker>>("/v1/workers"),
        getJson<Page<ReportedAllocations>>("/v1/allocations"),
      ]);
      this.items = workers.items;
      this.allocations = allocations.items;
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
