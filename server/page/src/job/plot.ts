// The plot of a curve: axes by unit, the main force strong, the rest thin, the maximum marked.
import uPlot from "uplot";
import type { Branch } from "./branches";
import { axisLabel, type Column } from "./columns";
import { drawBranches, nearestPoint } from "./loops";
import { drawMarks } from "./marks";

export interface PlotInput {
  columns: Column[];
  shown: boolean[];
  width: number;
  /** Gives a palette name's colour in the present light. */
  colour: (name: string) => string;
  /** How the curve runs now; it may turn back only as it grows. */
  course: () => Course;
  /** Told the point at the cursor, as a number in the plot's own ascending order. */
  onCursor: (index: number | null) => void;
  /** The point that the keyboard stands on, if it does. */
  pinned: () => number | null;
}

export interface Course {
  /** Values in the order of time, one list for each column. */
  values: number[][];
  turnsBack: boolean;
  branches: Branch[];
}

/** Dashes tell lines apart without colour; seven colours and four dashes repeat only together. */
const DASHES = [[], [6, 4], [2, 3], [9, 3, 2, 3]];
const COLOURS = 7;
/** Below this width [px] the axes give up some of theirs. */
const NARROW_PLOT = 520;
const FONT = "12px system-ui, sans-serif";

export function plotHeight(width: number): number {
  return Math.round(Math.min(430, Math.max(300, width * 0.48)));
}

export function plotOptions(input: PlotInput): uPlot.Options {
  const { columns, width, colour, shown } = input;
  const [horizontal, ...vertical] = columns;
  const linear = uPlot.paths.linear?.();
  // uPlot's own lines go right only; those that turn back are drawn when it is done with them.
  const paths: uPlot.Series.PathBuilder = (plot, line, first, last) =>
    input.course().turnsBack ? null : (linear?.(plot, line, first, last) ?? null);
  // A point is found by both its values where several stand above each other.
  const pointAt = (plot: uPlot, closest: number): number =>
    input.pinned() ?? (input.course().turnsBack ? nearestPoint(plot) : closest);
  const scales = scaleNames(vertical);
  // There is room for two axes: those of the first lines that are shown.
  const withAxis = scaleNames(vertical.filter((_, index) => shown[index + 1])).slice(0, 2);
  return {
    width,
    height: plotHeight(width),
    padding: [14, 8, 0, 0],
    legend: { show: false },
    cursor: { drag: { x: true, y: false }, points: { size: 7 }, y: false, dataIdx: (plot, _, closest) => pointAt(plot, closest) },
    scales: { x: { time: false }, ...Object.fromEntries(scales.map((name) => [name, { range: fromZero }])) },
    axes: [
      { ...axis("x", horizontal ? axisLabel(horizontal) : "", colour, true), size: 34, space: 42 },
      ...withAxis.map((scale, index) => ({
        ...axis(scale, scaleLabel(vertical, scale), colour, index === 0),
        side: index === 0 ? 3 : 1,
        size: width < NARROW_PLOT ? 40 : 52,
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
        points: { show: false },
        paths,
      })),
    ],
    hooks: {
      setCursor: [(plot) => input.onCursor(plot.cursor.idx == null ? null : (plot.cursor.idxs?.[0] ?? null))],
      drawSeries: [(plot, line) => input.course().turnsBack && drawBranches(plot, line, input.course())],
      draw: [(plot) => drawMarks(plot, columns, input.course(), colour)],
    },
  };
}

export function seriesColour(index: number): string {
  return `--series-${(index % COLOURS) + 1}`;
}

export function seriesDash(index: number): number[] {
  return DASHES[index % DASHES.length] ?? [];
}

function scaleOf(column: Column): string {
  return column.unit || column.label;
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
  return axisLabel(sharing.length === 1 ? first : { ...first, label: first.label.split(",")[0] ?? first.label });
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
    values: (_, splits) => splits.map((split) => String(Number(split.toPrecision(6))).replace("-", "−")),
  };
}

/** Zero belongs to a force axis, and a little room above the maximum to its mark. */
const fromZero: uPlot.Range.Function = (_, low, high) => {
  if (low === null || high === null || (low === 0 && high === 0)) return [0, 1];
  const room = (Math.max(high, 0) - Math.min(low, 0)) * 0.1;
  return [low < 0 ? low - room : 0, high > 0 ? high + room : 0];
};
