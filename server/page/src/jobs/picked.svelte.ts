// Jobs that a person has picked from the list, to do something with all of them.
import type { Job } from "../api/types";

export class Picked {
  jobs = $state.raw<Job[]>([]);
  /** The job that was picked last: with the shift key, all between are picked too. */
  #last: string | null = null;

  has(id: string): boolean {
    return this.jobs.some((job) => job.id === id);
  }

  /** Picks a job or lets it go, with all between it and the one before where `isRange`. */
  toggle(job: Job, shown: Job[], isRange: boolean): void {
    const isPicked = !this.has(job.id);
    const [from, to] = [this.#last, job.id].map((id) => shown.findIndex((other) => other.id === id));
    const isBetween = isRange && from !== undefined && to !== undefined && from >= 0 && to >= 0;
    this.#last = job.id;
    if (!isBetween) return this.setAll([job], isPicked);
    this.setAll(shown.slice(Math.min(from, to), Math.max(from, to) + 1), isPicked);
  }

  setAll(jobs: Job[], isPicked: boolean): void {
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    const ids = new Set(jobs.map(({ id }) => id));
    const others = this.jobs.filter(({ id }) => !ids.has(id));
    this.jobs = isPicked ? [...others, ...jobs] : others;
  }

  clear(): void {
    this.jobs = [];
  }
}
