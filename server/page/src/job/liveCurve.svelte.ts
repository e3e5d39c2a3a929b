// A curve that grows while the job runs, column by column as the plot wants it.
import { getJson, Refusal } from "../api/client";
import type { Curve, PointsReady } from "../api/types";

/** Points fetched at first: about two for each pixel of a wide plot. */
const FIRST_POINTS = 2000;
/** Beyond this many points the curve is fetched anew, thinned out by the server. */
const MOST_POINTS = 3 * FIRST_POINTS;

export class LiveCurve {
  columns = $state.raw<string[]>([]);
  /** One list of values for each column. */
  values = $state.raw<number[][]>([]);
  isComplete = $state(false);
  readonly #path: string;
  #next = 0;
  #attempt = 0;
  #fetching: Promise<void> | null = null;
  #isBehind = false;

  constructor(path: string) {
    this.#path = path;
  }

  get length(): number {
    return this.values[0]?.length ?? 0;
  }

  /** The server has more points. */
  grow({ attempt, total }: PointsReady): void {
    if (attempt !== this.#attempt || total !== this.#next) void this.fetch().catch(() => {});
  }

  /** Fetches what is new; calls that meet a fetch under way are served by one more after it. */
  async fetch(): Promise<void> {
    if (this.#fetching) {
      this.#isBehind = true;
      return this.#fetching;
    }
    this.#fetching = this.#fetchAll();
    try {
      await this.#fetching;
    } finally {
      this.#fetching = null;
    }
  }

  async #fetchAll(): Promise<void> {
    do {
      this.#isBehind = false;
      await this.#fetchOnce();
    } while (this.#isBehind);
  }

  async #fetchOnce(): Promise<void> {
    if (this.length > MOST_POINTS) this.#next = 0;
    const since = this.#next;
    try {
      const curve = await getJson<Curve>(`${this.#path}?since=${since}&max_points=${FIRST_POINTS}`);
      const continues = since > 0 && curve.attempt === this.#attempt && curve.next >= since;
      if (since > 0 && !continues) {
        // Another attempt computes the curve again; it starts from its own first point.
        this.#next = 0;
        this.#isBehind = true;
        return;
      }
      this.#take(curve, continues);
    } catch (error) {
      // Before the first point there is no curve to find.
      if (!(error instanceof Refusal && error.status === 404)) throw error;
    }
  }

  #take(curve: Curve, continues: boolean): void {
    const added = curve.columns.map((_, column) => curve.points.map((point) => point[column] ?? NaN));
    const isNew = !continues;
    if (isNew || curve.points.length > 0) {
      this.values = isNew ? added : added.map((column, index) => [...(this.values[index] ?? []), ...column]);
      this.columns = curve.columns;
    }
    this.#next = curve.next;
    this.#attempt = curve.attempt;
    this.isComplete = curve.complete;
  }
}
