// Curves side by side: scaled to a width or a maximum, gathered over seeds, held against one of them.
import type { ComparedCurve, Differences } from "../api/types";

/** A line of the plot. */
export interface Line {
  /** The job's id, or what else it is. */
  id: string;
  name: string;
  x: ArrayLike<number>;
  y: ArrayLike<number>;
  /** Whether it was measured rather than computed. */
  isMeasured?: boolean;
  /** Of a mean: the line a standard deviation below and above it. */
  band?: { low: ArrayLike<number>; high: ArrayLike<number> };
}

/** What ordinates are divided by. */
export type Scaling = "" | "maximum" | "width" | "grammage" | "thickness";

interface Divisor {
  label: string;
  /** Unit of the divisor, as it stands in the new unit; none for a ratio. */
  unit: string;
  size: (dimensions: Differences["jobs"][number]["dimensions"]) => number | undefined;
}

/** Sizes of a specimen that ordinates can be divided by, in units that give the usual ones: N/m, Pa. */
export const DIVISORS: Record<Exclude<Scaling, "" | "maximum">, Divisor> = {
  width: { label: "width", unit: "mm", size: ({ width_mm }) => width_mm },
  grammage: { label: "grammage", unit: "g/m²", size: ({ grammage_g_per_m2 }) => grammage_g_per_m2 },
  thickness: { label: "thickness", unit: "mm", size: ({ thickness_mm }) => thickness_mm },
};

export const SCALINGS: Scaling[] = ["", "maximum", "width", "grammage", "thickness"];

/** What the ordinates of a job are divided by; nothing where that is not known. */
export function divisorOf(scaling: Scaling, job: Differences["jobs"][number], y: ArrayLike<number>): number | null {
  if (scaling === "") return 1;
  const size = scaling === "maximum" ? maximumOf(y) : DIVISORS[scaling].size(job.dimensions);
  return size !== undefined && Number.isFinite(size) && size > 0 ? size : null;
}

/** The unit of an ordinate after it was divided. */
export function scaledUnit(unit: string, scaling: Scaling): string {
  if (scaling === "") return unit;
  if (scaling === "maximum") return "of its maximum";
  const { unit: below } = DIVISORS[scaling];
  return below.includes("/") ? `${unit || "1"}/(${below})` : `${unit || "1"}/${below}`;
}

export function maximumOf(values: ArrayLike<number>): number {
  let best = -Infinity;
  for (let index = 0; index < values.length; index++) best = Math.max(best, values[index] ?? -Infinity);
  return best;
}

/** A curve in the units shown. */
export function scaledLine(curve: ComparedCurve, name: string, factors: [x: number, y: number]): Line {
  const scaled = (values: number[], factor: number): Float64Array | number[] =>
    factor === 1 ? values : Float64Array.from(values, (value) => value * factor);
  return { id: curve.job, name, x: scaled(curve.x, factors[0]), y: scaled(curve.y, factors[1]) };
}

/** Whether abscissae never fall: only then a curve has one value at each. */
export function isAscending(x: ArrayLike<number>): boolean {
  for (let index = 1; index < x.length; index++) if ((x[index] ?? 0) < (x[index - 1] ?? 0)) return false;
  return true;
}

/** The value of an ascending curve at `place`, between its points on the straight line; NaN beyond its ends. */
export function valueAt({ x, y }: Pick<Line, "x" | "y">, place: number): number {
  const last = x.length - 1;
  if (last < 0 || place < (x[0] ?? NaN) || place > (x[last] ?? NaN)) return NaN;
  let [low, high] = [0, last];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((x[middle] ?? 0) <= place) low = middle;
    else high = middle;
  }
  const [x0 = NaN, x1 = NaN, y0 = NaN, y1 = NaN] = [x[low], x[high], y[low], y[high]];
  return x1 > x0 ? y0 + ((y1 - y0) * (place - x0)) / (x1 - x0) : place === x1 ? y1 : y0;
}

/** Points of a mean curve. */
const MEAN_POINTS = 400;

/**
 * Mean of ascending curves, with the standard deviation of single curves below and above it, over
 * the abscissae that all of them reach. Nothing where a curve turns back or they have no range in common.
 */
export function meanOf(lines: Line[], id: string, name: string): Line | null {
  const used = lines.filter(({ x }) => x.length > 1);
  if (used.length < 2 || used.some(({ x }) => !isAscending(x))) return null;
  const from = Math.max(...used.map(({ x }) => x[0] ?? NaN));
  const to = Math.min(...used.map(({ x }) => x[x.length - 1] ?? NaN));
  if (!(to > from)) return null;
  const x = Float64Array.from({ length: MEAN_POINTS }, (_, step) => from + ((to - from) * step) / (MEAN_POINTS - 1));
  x[MEAN_POINTS - 1] = to;
  const [y, low, high] = [0, 1, 2].map(() => new Float64Array(MEAN_POINTS)) as [
    Float64Array,
    Float64Array,
    Float64Array,
  ];
  x.forEach((place, index) => {
    const values = used.map((line) => valueAt(line, place));
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    const squares = values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
    const deviation = Math.sqrt(squares / (values.length - 1));
    y[index] = mean;
    low[index] = mean - deviation;
    high[index] = mean + deviation;
  });
  return { id, name, x, y, band: { low, high } };
}

/** Jobs that are alike but for the seed, as places in the list; in the order of their first. */
export function groupsOfSeeds({ jobs, fields, specs_left_out }: Differences): number[][] {
  const others = fields.filter(({ pointer }) => pointer !== "/spec/seed");
  const groups = new Map<string, number[]>();
  jobs.forEach((job, place) => {
    // What was not looked at is alike only where all of it is.
    const whole = specs_left_out.includes(job.id) ? job.spec_sha256 : "";
    const key = JSON.stringify([job.kind, whole, ...others.map(({ values }) => values[place])]);
    groups.set(key, [...(groups.get(key) ?? []), place]);
  });
  return [...groups.values()];
}

/**
 * Area between two ascending curves, ∫ |a − b| dx, over the abscissae that both reach: between their points
 * both are straight, and where they cross the area is that of two triangles. NaN where one turns back.
 */
export function areaBetween(a: Line, b: Line): number {
  if (!isAscending(a.x) || !isAscending(b.x)) return NaN;
  const from = Math.max(a.x[0] ?? NaN, b.x[0] ?? NaN);
  const to = Math.min(a.x[a.x.length - 1] ?? NaN, b.x[b.x.length - 1] ?? NaN);
  if (!(to > from)) return NaN;
  const inside = [...Array.from(a.x), ...Array.from(b.x)].filter((place) => place > from && place < to);
  const places = Float64Array.from([from, ...inside, to]).sort();
  let area = 0;
  let before = valueAt(a, from) - valueAt(b, from);
  for (let index = 1; index < places.length; index++) {
    const [left = NaN, right = NaN] = [places[index - 1], places[index]];
    const after = valueAt(a, right) - valueAt(b, right);
    const [one, other] = [Math.abs(before), Math.abs(after)];
    const crosses = before * after < 0;
    area += (right - left) * (crosses ? (one * one + other * other) / (2 * (one + other)) : (one + other) / 2);
    before = after;
  }
  return area;
}
