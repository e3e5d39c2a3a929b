// What is compared: fetched by its selection, shown by choices that stand in the address.
import { complaintsOf, getJson } from "../api/client";
import type { Comparison as Kept, Curves, Differences } from "../api/types";
import { describeColumns, drawnOver, mainLine, usualHorizontal } from "../plot/columns";
import { axisLabel, describeAll, type Column } from "../plot/names";
import { colouring, qualitiesOf, type Colouring } from "./colours";
import { divisorOf, groupsOfSeeds, meanOf, scaledLine, scaledUnit, SCALINGS, type Line, type Scaling } from "./curves";

/** Parts of an address that choose jobs; all others say how these are shown. */
const CHOOSING = ["jobs", "comparison", "tag", "project", "q", "kind", "status", "outcome"];

/** How a comparison is shown. */
export interface View {
  over: string;
  of: string;
  /** What colours are by: a field's pointer or a result. */
  by: string;
  scaling: Scaling;
  /** Whether curves that differ by the seed alone are drawn as their mean. */
  isMean: boolean;
  /** The job that others are held against. */
  reference: string;
}

/** Points of all curves that a browser draws without effort. */
const ALL_POINTS = 200_000;
const LEAST_POINTS = 400;
const MOST_POINTS = 2_000;

export class Comparison {
  differences = $state.raw<Differences | null>(null);
  curves = $state.raw<Curves | null>(null);
  kept = $state.raw<Kept | null>(null);
  errors = $state.raw<string[]>([]);
  measured = $state.raw<Line | null>(null);
  view = $state<View>({ over: "", of: "", by: "", scaling: "", isMean: false, reference: "" });
  /** The part of the address that chooses the jobs. */
  readonly selection: URLSearchParams;
  #loading: AbortController | null = null;

  constructor(id: string | null, query: URLSearchParams) {
    const chosen = [...query].filter(([key]) => CHOOSING.includes(key));
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    this.selection = new URLSearchParams(id === null ? chosen : { comparison: id });
    this.view = viewOf(query);
  }

  get isChosen(): boolean {
    return [...this.selection].length > 0;
  }

  /** Fetches what differs, then the curves. */
  async load(): Promise<void> {
    const id = this.selection.get("comparison");
    try {
      if (id !== null) {
        this.kept = await getJson<Kept>(`/v1/comparisons/${encodeURIComponent(id)}`);
        // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
        if (this.query().toString() === "") this.view = viewOf(new URLSearchParams(this.kept.view));
      }
      this.differences = await getJson<Differences>(`/v1/differences?${this.selection}`);
      await this.loadCurves();
    } catch (error) {
      this.errors = complaintsOf(error);
    }
  }

  async loadCurves(): Promise<void> {
    this.#loading?.abort();
    const loading = new AbortController();
    this.#loading = loading;
    const { over, of } = this.shown;
    if (over === "" || of === "") return;
    const count = Math.max(1, this.differences?.jobs.length ?? 1);
    const points = Math.round(Math.min(MOST_POINTS, Math.max(LEAST_POINTS, ALL_POINTS / count)));
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    const query = new URLSearchParams([...this.selection, ["over", over], ["of", of], ["points", String(points)]]);
    try {
      this.curves = await getJson<Curves>(`/v1/curves?${query}`, loading.signal);
      this.errors = [];
    } catch (error) {
      if (!loading.signal.aborted) this.errors = complaintsOf(error);
    }
  }

  /** All columns of the curves, those of the first job first. */
  get columns(): Column[] {
    const names = (this.differences?.jobs ?? []).flatMap(({ columns }) => columns);
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    return describeAll([...new Set(names)]);
  }

  /** The columns drawn: those chosen, as far as there are such. */
  get shown(): { over: string; of: string } {
    const names = this.columns.map(({ name }) => name);
    const first = this.differences?.jobs.find(({ columns }) => columns.length > 1)?.columns ?? [];
    const over = names.includes(this.view.over) ? this.view.over : usualHorizontal(first);
    const drawn = describeColumns(drawnOver(over, first));
    const main = drawn[mainLine(drawn)]?.name ?? "";
    return { over, of: names.includes(this.view.of) ? this.view.of : main };
  }

  /** Horizontal and vertical column as they are shown. */
  get pair(): [Column, Column] | null {
    const find = (name: string): Column | undefined => this.columns.find((column) => column.name === name);
    const [x, y] = [find(this.shown.over), find(this.shown.of)];
    return x && y ? [x, y] : null;
  }

  get axes(): [string, string] {
    const { pair, view } = this;
    if (!pair) return ["", ""];
    const [x, y] = pair;
    return [axisLabel(x), axisLabel({ ...y, unit: scaledUnit(y.unit, view.scaling) })];
  }

  /** Every job's line in the units shown, and the jobs that have none. */
  readonly lines = $derived.by(() => this.#lines());

  #lines(): { lines: Line[]; without: number } {
    const { differences, curves, pair, view } = this;
    const lines: Line[] = [];
    if (!differences || !curves || !pair) return { lines, without: 0 };
    const [x, y] = pair;
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    const jobs = new Map(differences.jobs.map((job) => [job.id, job]));
    for (const curve of curves.curves) {
      const job = jobs.get(curve.job);
      const divisor = job ? divisorOf(view.scaling, job, curve.y) : null;
      if (!job || divisor === null || curve.x.length === 0) continue;
      const factor = view.scaling === "maximum" ? 1 : y.factor;
      lines.push(scaledLine(curve, job.name || job.id.slice(-8), [x.factor, factor / divisor]));
    }
    return { lines, without: differences.jobs.length - lines.length };
  }

  /** Means over seeds where they are asked for and can be taken; single curves else. */
  readonly drawn = $derived.by(() => this.#drawn());

  #drawn(): Line[] {
    const { lines } = this.lines;
    if (!this.view.isMean || !this.differences) return lines;
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    const byId = new Map(lines.map((line) => [line.id, line]));
    const { jobs } = this.differences;
    return groupsOfSeeds(this.differences).flatMap((places) => {
      const own = places.flatMap((place) => byId.get(jobs[place]?.id ?? "") ?? []);
      const first = own[0];
      const mean = first && meanOf(own, first.id, `${first.name}, mean of ${own.length}`);
      return mean ? [mean] : own;
    });
  }

  readonly colouring = $derived.by(() => this.#colouring());

  #colouring(): Colouring {
    const { differences, view } = this;
    if (!differences) return { colours: [], legend: [], isRamp: false };
    const names = differences.jobs.map(({ name, id }) => name || id.slice(-8));
    return colouring(
      qualitiesOf(differences).find(({ key }) => key === view.by),
      names,
    );
  }

  /** How it is shown, as the query of an address. */
  query(): URLSearchParams {
    const { over, of, by, scaling, isMean, reference } = this.view;
    const all = { over, of, by, per: scaling, mean: isMean ? "1" : "", reference };
    // eslint-disable-next-line svelte/prefer-svelte-reactivity -- made and read at once
    return new URLSearchParams(Object.entries(all).filter(([, value]) => value !== ""));
  }
}

function viewOf(query: URLSearchParams): View {
  const read = (name: string): string => query.get(name) ?? "";
  const scaling = SCALINGS.find((one) => one === read("per")) ?? "";
  const isMean = read("mean") === "1";
  return { over: read("over"), of: read("of"), by: read("by"), scaling, isMean, reference: read("reference") };
}
