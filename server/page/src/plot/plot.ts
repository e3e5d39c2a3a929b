// How a plot is drawn: axes by unit, what matters strong, the rest thin.
import uPlot from "uplot";
import type { Course } from "./branches";
import { axisLabel, stemOf, type Column } from "./names";
import { drawBranches, nearestPoint } from "./loops";
import { drawMarks } from "./marks";
import { seriesColour, seriesDash, type Palette, type PlotStyle } from "./style";

export interface PlotInput {
  columns: Column[];
  shown: boolean[];
  style: PlotStyle;
  /** Whether the first column counts something. */
  isWhole: boolean;
  width: number;
  colour: Palette;
  /** How the curve runs now; it may turn back only as it grows. */
  course: () => Course;
  /** Told the point at the cursor, as a number in the plot's own ascending order. */
  onCursor: (index: number | null) => void;
  /** The point that the keyboard stands on, if it does. */
  pinned: () => number | null;
}

/** Below this width [px] the axes give up some of theirs. */
const NARROW_PLOT = 520;
const WHOLE_STEPS = [1, 2, 5].flatMap((step) => [step, 10 * step, 100 * step, 1000 * step]).toSorted((a, b) => a - b);
const FONT = "12px system-ui, sans-serif";

export function plotHeight(width: number): number {
  return Math.round(Math.min(430, Math.max(300, width * 0.48)));
}

export function plotOptions(input: PlotInput): uPlot.Options {
  const { columns, width, colour, shown, style } = input;
  const [horizontal, ...vertical] = columns;
  const linear = uPlot.paths.linear?.();
  // uPlot's own lines go right only; those that turn back are drawn when it is done with them.
  const paths: uPlot.Series.PathBuilder = (plot, line, first, last) =>
    input.course().turnsBack ? null : (linear?.(plot, line, first, last) ?? null);
  // A point is found by both its values where several stand above each other.
  const pointAt = (plot: uPlot, closest: number): number =>
    input.pinned() ?? (input.course().turnsBack ? nearestPoint(plot) : closest);
  const scales = scaleNames(vertical);
  const { isUpright = false } = style;
  // There is room for two axes: those of the first lines that are shown.
  const withAxis = scaleNames(vertical.filter((_, index) => shown[index + 1])).slice(0, 2);
  return {
    width,
    height: plotHeight(width),
    // A number may stand at the very end; on the right of a second axis there is room for it.
    padding: [14, withAxis.length > 1 ? 8 : 18, 0, 0],
    legend: { show: false },
    cursor: {
      drag: { x: !isUpright, y: isUpright },
      points: { size: 7 },
      x: !isUpright,
      y: isUpright,
      dataIdx: (plot, _, closest) => pointAt(plot, closest),
    },
    scales: {
      x: { time: false, ori: isUpright ? 1 : 0, ...(style.isLogarithmic && { distr: 3, range: toTheEnds }) },
      ...Object.fromEntries(
        scales.map((name) => [name, { ori: isUpright ? 0 : 1, ...(!style.floats && { range: fromZero }) }]),
      ),
    },
    axes: [
      {
        ...axis("x", horizontal ? axisLabel(horizontal) : "", colour, true),
        ...sideOf(isUpright ? 3 : 2, width),
        ...(style.isLogarithmic && (style.hasPoints ? atPoints : atDigits)),
        ...(input.isWhole && { incrs: WHOLE_STEPS }),
      },
      ...withAxis.map((scale, index) => ({
        ...axis(scale, scaleLabel(vertical, scale), colour, index === 0),
        ...sideOf(isUpright ? (index === 0 ? 2 : 0) : index === 0 ? 3 : 1, width),
      })),
    ],
    series: [
      {},
      ...vertical.map((column, index) => ({
        label: column.label,
        scale: scaleOf(column),
        show: shown[index + 1] ?? false,
        stroke: colour(seriesColour(index)),
        width: column.isMinor ? 1.1 : 2.2,
        dash: seriesDash(index),
        points: { show: style.hasPoints ?? false, size: 7, fill: colour("--surface") },
        paths,
      })),
    ],
    hooks: {
      setCursor: [(plot) => input.onCursor(plot.cursor.idx == null ? null : (plot.cursor.idxs?.[0] ?? null))],
      drawSeries: [(plot, line) => input.course().turnsBack && drawBranches(plot, line, input.course())],
      draw: [(plot) => style.marksMaximum && drawMarks(plot, columns, input.course(), colour)],
    },
  };
}

/** Lines of one unit share a scale; without a unit, those whose names begin alike. */
function scaleOf({ label, unit }: Column): string {
  return unit || stemOf(label);
}

/** One scale for each unit, in the order of the columns. */
function scaleNames(columns: Column[]): string[] {
  return [...new Set(columns.map(scaleOf))];
}

/** An axis that several columns share is named by what they have in common. */
function scaleLabel(columns: Column[], scale: string): string {
  const sharing = columns.filter((column) => scaleOf(column) === scale);
  const first = sharing[0];
  if (!first) return scale;
  return axisLabel(sharing.length === 1 ? first : { ...first, label: stemOf(first.label) });
}

function axis(scale: string, label: string, colour: PlotInput["colour"], hasGrid: boolean): uPlot.Axis {
  return {
    scale,
    label,
    stroke: colour("--muted"),
    font: FONT,
    labelFont: FONT,
    labelSize: 18,
    grid: { show: hasGrid, stroke: colour("--line"), width: 1 },
    ticks: { stroke: colour("--line"), width: 1, size: 5 },
    // A logarithmic axis leaves out what it has no room for.
    values: (_, splits) =>
      splits.map((split: number | null) =>
        split === null ? "" : String(Number(split.toPrecision(6))).replace("-", "−"),
      ),
  };
}

/** Where an axis stands: 0 above, then clockwise. */
function sideOf(side: 0 | 1 | 2 | 3, width: number): uPlot.Axis {
  if (side % 2 === 0) return { side, size: 34, space: 42 };
  const least = width < NARROW_PLOT ? 46 : 52;
  return { side, size: (_, texts) => Math.max(least, ROOM + DIGIT * longestOf(texts)) };
}

/** Mark, gaps and a digit of a number on an axis [px]. */
const ROOM = 14;
const DIGIT = 7;

function longestOf(texts: string[] | null): number {
  return Math.max(0, ...(texts ?? []).map((text) => text.length));
}

/** Room for a number on a logarithmic axis [px]. */
const NUMBER_SPACE = 28;

/** Marks at 1, 2, ..., 9 times each power of ten; the plot's own would count on from the lowest value. */
const atDigits: uPlot.Axis = {
  space: NUMBER_SPACE,
  splits: (_plot, _axis, low, high) => digitsOfPowers(low, high),
};

/** Marks at the values themselves; of those that stand too near, the larger has its number. */
const atPoints: uPlot.Axis = {
  splits: (plot) => [...new Set(plot.data[0])],
  filter: (plot, splits) => {
    let taken = Infinity;
    const numbered = splits.toReversed().map((split) => {
      const place = plot.valToPos(split, "x");
      if (taken - place < NUMBER_SPACE) return null;
      taken = place;
      return split;
    });
    return numbered.toReversed();
  },
};

function digitsOfPowers(low: number, high: number): number[] {
  const marks: number[] = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
    for (let digit = 1; digit < 10; digit++) marks.push(Number(`${digit}e${power}`));
  }
  return marks.filter((mark) => mark >= low && mark <= high);
}

/** By itself a logarithmic scale would go on to the next power of ten. */
const toTheEnds: uPlot.Range.Function = (_, low, high) => [low / 1.06, high * 1.06];

/** Zero belongs to a force axis, and a little room above the maximum to its mark. */
const fromZero: uPlot.Range.Function = (_, low, high) => {
  if (low === null || high === null || (low === 0 && high === 0)) return [0, 1];
  const room = (Math.max(high, 0) - Math.min(low, 0)) * 0.1;
  return [low < 0 ? low - room : 0, high > 0 ? high + room : 0];
};
