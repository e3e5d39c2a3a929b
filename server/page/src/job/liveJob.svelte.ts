// One job as it stands on the server, with everything its page shows.
import { getJson, messageOf, Refusal, sendJson, Unreachable } from "../api/client";
import type { FileEntry, Job, JobChanges, JobEvent, LogLine, Outcome, Page } from "../api/types";
import { LiveCurve } from "./liveCurve.svelte";

/** The log has no event of its own; it is read again at most this often [ms] while events come. */
const LOG_PAUSE = 3000;

/** What a list holds; nothing where it is not shown, as by a share link without files. */
async function itemsOf<T>(path: string): Promise<T[]> {
  try {
    return (await getJson<Page<T>>(path)).items;
  } catch (error) {
    if (error instanceof Refusal && error.status === 403) return [];
    throw error;
  }
}

export class LiveJob {
  job = $state.raw<Job | null>(null);
  outcome = $state.raw<Outcome | null>(null);
  files = $state.raw<FileEntry[]>([]);
  log = $state.raw<LogLine[]>([]);
  error = $state("");
  isDeleted = $state(false);
  readonly curve: LiveCurve;
  readonly #path: string;
  #logTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(id: string) {
    this.#path = `/v1/jobs/${encodeURIComponent(id)}`;
    this.curve = new LiveCurve(`${this.#path}/curve`);
  }

  /** Fetches everything again. */
  async refresh(): Promise<void> {
    if (this.isDeleted) return;
    try {
      const job = await getJson<Job>(this.#path);
      this.error = "";
      this.#take(job);
      await this.#readRest();
    } catch (error) {
      // That the server is away is said once, by the banner.
      if (!(error instanceof Unreachable)) this.error = messageOf(error);
    }
  }

  event({ event, data }: JobEvent): void {
    const before = this.job;
    switch (event) {
      case "job":
        this.#take(data);
        // The first fetch is under way: it brings the rest, but may be older than this event.
        if (!before) return;
        if (before.status !== this.job?.status || before.attempt !== this.job.attempt) {
          void this.#readRest().catch(() => {});
        } else this.#readLogSoon();
        return;
      case "progress":
        if (!before) return;
        if (before.status === "running") {
          const { progress, phase, eta_s } = data;
          this.job = { ...before, progress, phase, eta_s };
        }
        this.#readLogSoon();
        return;
      case "points":
        if (before) this.curve.grow(data);
        return;
      case "deleted":
        this.isDeleted = true;
    }
  }

  /** `cancel`, `pause`, `resume` or `retry`. */
  async act(action: string): Promise<void> {
    this.#take(await sendJson<Job>("POST", `${this.#path}/${action}`));
    await this.refresh();
  }

  async change(changes: JobChanges): Promise<void> {
    this.#take(await sendJson<Job>("PATCH", this.#path, changes));
  }

  stop(): void {
    clearTimeout(this.#logTimer);
  }

  /** Takes a job unless a newer state of it is known: answers and events may overtake each other. */
  #take(job: Job): void {
    const isOlder = this.job !== null && Date.parse(job.updated_at) < Date.parse(this.job.updated_at);
    // Events leave the spec out, which never changes.
    this.job = { ...(isOlder && this.job ? this.job : job), spec: job.spec ?? this.job?.spec };
  }

  /** Reads everything beside the job itself; before its first attempt there is nothing. */
  async #readRest(): Promise<void> {
    const hasBegun = this.job !== null && this.job.attempt > 0;
    await Promise.all([hasBegun ? this.curve.fetch() : null, this.#readLog(), this.#readResults()]);
  }

  async #readResults(): Promise<void> {
    const succeeded = this.job?.outcome === "succeeded";
    const [outcome, files] = await Promise.all([
      succeeded ? getJson<Outcome>(`${this.#path}/outcome`) : null,
      this.job?.status === "finished" ? itemsOf<FileEntry>(`${this.#path}/files`) : [],
    ]);
    this.outcome = outcome;
    this.files = files;
  }

  async #readLog(): Promise<void> {
    clearTimeout(this.#logTimer);
    this.#logTimer = undefined;
    this.log = await itemsOf<LogLine>(`${this.#path}/log`);
  }

  #readLogSoon(): void {
    this.#logTimer ??= setTimeout(() => void this.#readLog().catch(() => {}), LOG_PAUSE);
  }
}
