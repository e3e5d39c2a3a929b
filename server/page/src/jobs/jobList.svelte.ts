// The job list as it stands on the server: fetched in pages, kept true by events.
import { getJson, messageOf, Unreachable } from "../api/client";
import type { Job, JobEvent, Page } from "../api/types";

export interface Filter {
  /** A status or, for jobs that have ended, an outcome. */
  status: string;
  kind: string;
  tag: string;
  text: string;
  /** One's own, those of one's groups, or what others share. */
  whose: string;
  project: string;
  /** Conditions on specs and results, as the server reads them. */
  where: string;
}

/** What of it the server sorts by and shows beside. */
export interface Beside {
  sort: string;
  show: string;
}

export const STATUSES = ["queued", "running", "paused", "finished"];
export const OUTCOMES = ["succeeded", "failed", "cancelled", "timed_out", "quarantined"];

/** A filter that lets every job pass. */
export const EVERYTHING: Filter = { status: "", kind: "", tag: "", text: "", whose: "", project: "", where: "" };

const PAGE = 50;
/** Largest page the server gives. */
const LARGEST_PAGE = 200;
/** Events come in bursts when a queue drains; the list is fetched at most this often [ms]. */
const REFRESH_PAUSE = 700;

export class JobList {
  jobs = $state.raw<Job[]>([]);
  next = $state.raw<string | null>(null);
  isLoaded = $state(false);
  isLoadingMore = $state(false);
  error = $state("");
  /** So many jobs the server looked at before it stopped short of all; null where it did not. */
  stoppedAfter = $state<number | null>(null);
  /** Whether what is sorted is the newest of all alone, and whether that will be otherwise in some minutes. */
  newestOnly = $state(false);
  isGathering = $state(false);
  #beside: Beside = { sort: "", show: "" };
  #filter: Filter = EVERYTHING;
  #loading: AbortController | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;

  get isFiltered(): boolean {
    return Object.values(this.#filter).some((value) => value !== "");
  }

  show(filter: Filter, beside: Beside): void {
    this.#filter = filter;
    this.#beside = beside;
    void this.load(PAGE);
  }

  /** Fetches the first `count` jobs again; a newer call replaces an older one. */
  async load(count = Math.max(PAGE, this.jobs.length)): Promise<void> {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#loading?.abort();
    const loading = new AbortController();
    this.#loading = loading;
    try {
      const jobs: Job[] = [];
      let cursor: string | null = null;
      let page: Page<Job>;
      do {
        page = await getJson(this.#address(cursor, count - jobs.length), loading.signal);
        jobs.push(...page.items);
        cursor = page.next;
        // A search that stopped is gone on with when somebody asks.
      } while (cursor !== null && jobs.length < count && page.stopped_after === undefined);
      this.jobs = jobs;
      this.#goOnFrom(page);
      this.error = "";
      this.isLoaded = true;
    } catch (error) {
      // That the server is away is said once, by the banner.
      if (!loading.signal.aborted && !(error instanceof Unreachable)) this.error = messageOf(error);
    }
  }

  async loadMore(): Promise<void> {
    if (this.next === null || this.isLoadingMore) return;
    this.isLoadingMore = true;
    try {
      const page = await getJson<Page<Job>>(this.#address(this.next, PAGE));
      const known = this.jobs.map((job) => job.id);
      this.jobs = [...this.jobs, ...page.items.filter((job) => !known.includes(job.id))];
      this.#goOnFrom(page);
    } catch (error) {
      this.error = messageOf(error);
    }
    this.isLoadingMore = false;
  }

  event({ event, data }: JobEvent): void {
    switch (event) {
      case "job":
        this.#change(data.id, () => data);
        // Order, filters and queue positions are the server's to decide.
        this.#timer ??= setTimeout(() => void this.load(), REFRESH_PAUSE);
        return;
      case "progress": {
        const { job_id, progress, phase, eta_s } = data;
        this.#change(job_id, (job) => ({ ...job, progress, phase, eta_s }));
        return;
      }
      case "deleted":
        this.jobs = this.jobs.filter((job) => job.id !== data.job_id);
        return;
      case "points":
      // The list shows no curves.
    }
  }

  stop(): void {
    clearTimeout(this.#timer);
    this.#loading?.abort();
  }

  #goOnFrom(page: Page<Job>): void {
    this.next = page.next;
    this.stoppedAfter = page.stopped_after ?? null;
    this.newestOnly = page.newest_only ?? false;
    this.isGathering = page.gathering ?? false;
  }

  #address(cursor: string | null, count: number): string {
    return addressOf(this.#filter, this.#beside, cursor, count);
  }

  #change(id: string, change: (job: Job) => Job): void {
    const index = this.jobs.findIndex((job) => job.id === id);
    const job = this.jobs[index];
    if (job) this.jobs = this.jobs.with(index, change(job));
  }
}

/** Where the server lists `count` jobs that pass the filter, from the cursor on. */
function addressOf(filter: Filter, beside: Beside, cursor: string | null, count: number): string {
  const { status: state, text, ...named } = filter;
  const [status, outcome] = STATUSES.includes(state) ? [state, ""] : ["", state];
  const limit = String(Math.min(count, LARGEST_PAGE));
  const given = Object.entries({ limit, ...named, status, outcome, q: text, ...beside, cursor: cursor ?? "" });
  return `/v1/jobs?${new URLSearchParams(given.filter(([, value]) => value !== "")).toString()}`;
}
