// The plot of a curve: axes by unit, the main force strong, the rest thin, the maximum marked.
import uPlot from "uplot";
import { formatNumber, NARROW } from "../format/numbers";
import { axisLabel, indexOfMaximum, mainLine, type Column } from "./columns";

export interface PlotInput {
  columns: Column[];
  shown: boolean[];
  width: number;
  /** Gives a palette name's colour in the present light. */
  colour: (name: string) => string;
  onCursor: (index: number | null) => void;
}

/** Dashes tell lines apart without colour; seven colours and four dashes repeat only together. */
const DASHES = [[], [6, 4], [2, 3], [9, 3, 2, 3]];
const COLOURS = 7;
/** Below this width [px] the axes give up some of theirs. */
const NARROW_PLOT = 520;
const FONT = "12px system-ui, sans-serif";
const MARK_FONT = "600 12px system-ui, sans-serif";

export function plotHeight(width: number): number {
  return Math.round(Math.min(430, Math.max(300, width * 0.48)));
}

export function plotOptions(input: PlotInput): uPlot.Options {
  const { columns, width, colour, shown } = input;
  const [horizontal, ...vertical] = columns;
  const scales = scaleNames(vertical);
  // There is room for two axes: those of the first lines that are shown.
  const withAxis = scaleNames(vertical.filter((_, index) => shown[index + 1])).slice(0, 2);
  return {
    width,
    height: plotHeight(width),
    padding: [14, 8, 0, 0],
    legend: { show: false },
    cursor: { drag: { x: true, y: false }, points: { size: 7 }, y: false },
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
      })),
    ],
    hooks: {
      setCursor: [(plot) => input.onCursor(plot.cursor.idx ?? null)],
      draw: [(plot) => markMaximum(plot, columns, colour)],
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

function markMaximum(plot: uPlot, columns: Column[], colour: PlotInput["colour"]): void {
  const main = mainLine(columns);
  const column = columns[main];
  const series = plot.series[main];
  const values = plot.data[main] as number[] | undefined;
  if (!column || !series?.show || !values) return;
  const best = indexOfMaximum(values);
  const x = plot.data[0][best];
  const y = values[best];
  if (x === undefined || y === undefined || y <= 0) return;
  const left = plot.valToPos(x, "x", true);
  const top = plot.valToPos(y, series.scale ?? "y", true);
  if (left < plot.bbox.left || left > plot.bbox.left + plot.bbox.width) return;
  const ratio = devicePixelRatio;
  const context = plot.ctx;
  context.save();
  context.fillStyle = colour("--surface");
  context.strokeStyle = colour(seriesColour(main - 1));
  context.lineWidth = 2 * ratio;
  // The line drawn last leaves its dashes behind.
  context.setLineDash([]);
  context.beginPath();
  context.arc(left, top, 4.5 * ratio, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  context.font = MARK_FONT.replace("12px", `${12 * ratio}px`);
  context.fillStyle = colour("--ink");
  // Inside the plot, on the side with more room.
  const isRight = left > plot.bbox.left + plot.bbox.width / 2;
  context.textAlign = isRight ? "right" : "left";
  context.textBaseline = "bottom";
  const text = `max ${formatNumber(y)}${NARROW}${column.unit}`;
  context.fillText(text, left + (isRight ? -1 : 1) * 9 * ratio, top - 3 * ratio);
  context.restore();
}
