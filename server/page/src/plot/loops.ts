// Lines that turn back: loading solid, unloading dashed, earlier cycles paler.
import type uPlot from "uplot";
import type { Course } from "./branches";

/** Dashes of unloading [px]. */
const UNLOADING = [5, 4];
/** Strength of the first cycle's lines; that of the last is 1. */
const PALEST = 0.35;

/** Draws one line through its points in the order of time. */
export function drawBranches(plot: uPlot, line: number, { values, branches }: Course): void {
  const series = plot.series[line];
  const [xs, ys] = [values[0], values[line]];
  const scale = series?.scale;
  if (!series || !scale || !xs || !ys) return;
  const { ctx, bbox } = plot;
  const ratio = devicePixelRatio;
  const cycles = branches.at(-1)?.cycle ?? 1;
  const stroke = typeof series.stroke === "function" ? series.stroke(plot, line) : series.stroke;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.strokeStyle = stroke ?? "";
  ctx.lineWidth = (series.width ?? 1) * ratio;
  ctx.lineJoin = "round";
  for (const { first, last, cycle, isUnloading } of branches) {
    ctx.globalAlpha = cycles > 1 ? PALEST + ((1 - PALEST) * (cycle - 1)) / (cycles - 1) : 1;
    ctx.setLineDash((isUnloading ? UNLOADING : (series.dash ?? [])).map((length) => length * ratio));
    ctx.beginPath();
    for (let row = first; row <= last; row++) {
      // A point without a value is left out, as the canvas does by itself.
      ctx.lineTo(plot.valToPos(xs[row] ?? NaN, "x", true), plot.valToPos(ys[row] ?? NaN, scale, true));
    }
    ctx.stroke();
  }
  ctx.restore();
}

/** The point nearest to the cursor on any line shown, in the plot's own ascending order. */
export function nearestPoint(plot: uPlot): number {
  const { left = 0, top = 0 } = plot.cursor;
  const positions = plot.data[0].map((x) => plot.valToPos(x, "x") - left);
  let best = 0;
  let least = Infinity;
  plot.series.forEach(({ show, scale }, line) => {
    if (line === 0 || !show || !scale) return;
    plot.data[line]?.forEach((y, index) => {
      const distance = Math.hypot(positions[index] ?? NaN, plot.valToPos(y ?? NaN, scale) - top);
      if (distance < least) [best, least] = [index, distance];
    });
  });
  return best;
}
