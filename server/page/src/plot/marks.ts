// What is written into the plot: the maximum of the main line, and the numbers of its cycles.
import type uPlot from "uplot";
import { formatNumber, NARROW } from "../format/numbers";
import type { Course } from "./branches";
import { indexOfMaximum, mainLine } from "./columns";
import type { Column } from "./names";
import { seriesColour, type Palette } from "./style";

const FONT_SIZE = 12;
/** Room between two texts side by side [px]. */
const GAP = 6;

type Box = [left: number, top: number, right: number, bottom: number];

export function drawMarks(plot: uPlot, columns: Column[], course: Course, colour: Palette): void {
  const main = mainLine(columns);
  const column = columns[main];
  const series = plot.series[main];
  const values = course.values[main];
  if (!column || !series?.show || !values) return;
  const context = plot.ctx;
  const ratio = devicePixelRatio;
  context.save();
  context.font = `600 ${FONT_SIZE * ratio}px system-ui, sans-serif`;
  context.textBaseline = "bottom";
  // The line drawn last leaves its dashes behind.
  context.setLineDash([]);
  const place = (row: number): [left: number, top: number] => [
    plot.valToPos(course.values[0]?.[row] ?? NaN, "x", true),
    plot.valToPos(values[row] ?? NaN, series.scale ?? "y", true),
  ];
  const taken: Box[] = [];
  const best = indexOfMaximum(values);
  const [left, top] = place(best);
  if ((values[best] ?? 0) > 0 && isWithin(plot, left)) {
    context.fillStyle = colour("--surface");
    context.strokeStyle = colour(seriesColour(main - 1));
    context.lineWidth = 2 * ratio;
    context.beginPath();
    context.arc(left, top, 4.5 * ratio, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    context.fillStyle = colour("--ink");
    // Inside the plot, on the side with more room.
    const side = left > plot.bbox.left + plot.bbox.width / 2 ? -1 : 1;
    context.textAlign = side < 0 ? "right" : "left";
    const text = `max ${formatNumber(values[best] ?? NaN)}${NARROW}${column.unit}`;
    const start = left + side * 9 * ratio;
    context.fillText(text, start, top - 3 * ratio);
    const end = start + side * context.measureText(text).width;
    taken.push([Math.min(start, end), top - (3 + FONT_SIZE) * ratio, Math.max(start, end), top]);
  }
  if (course.turnsBack) {
    context.fillStyle = colour("--muted");
    context.textAlign = "center";
    for (const [cycle, row] of peaks(course, values)) number(String(cycle), place(row));
  }
  context.restore();

  /** Writes a cycle's number under its peak where there is room. */
  function number(text: string, [left, top]: [number, number]): void {
    const half = context.measureText(text).width / 2 + GAP * ratio;
    const box: Box = [left - half, top + 6 * ratio, left + half, top + (6 + FONT_SIZE) * ratio];
    if (!isWithin(plot, left) || taken.some((other) => overlap(box, other))) return;
    taken.push(box);
    context.lineWidth = 4 * ratio;
    context.lineJoin = "round";
    context.strokeStyle = colour("--surface");
    context.strokeText(text, left, box[3]);
    context.fillText(text, left, box[3]);
  }
}

/** The row of each cycle's largest value; nothing when there is only one cycle. */
function peaks({ branches }: Course, values: number[]): [cycle: number, row: number][] {
  const rows = new Map<number, number>();
  for (const { cycle, first, last } of branches) {
    for (let row = first; row <= last; row++) {
      const best = rows.get(cycle);
      if (best === undefined || (values[row] ?? -Infinity) > (values[best] ?? -Infinity)) rows.set(cycle, row);
    }
  }
  return rows.size > 1 ? [...rows] : [];
}

function isWithin({ bbox }: uPlot, left: number): boolean {
  return left >= bbox.left && left <= bbox.left + bbox.width;
}

function overlap(a: Box, b: Box): boolean {
  return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}
