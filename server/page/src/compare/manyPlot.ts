// Many curves in one plot. uPlot gives axes, zoom and cursor; the curves have abscissae of their own, which
// it could only join into one long list, so they are drawn on its canvas here.
//
// While somebody zooms, each frame shows the last picture stretched to the new range, which takes a
// millisecond however many curves there are; it is drawn anew as soon as the range rests.
import uPlot from "uplot";
import type { Line } from "./curves";
import type { Palette } from "../plot/style";

export interface Drawn extends Line {
  /** A colour, or a name of the palette. */
  colour: string;
}

export interface Range {
  x: [number, number];
  y: [number, number];
}

export interface ManyInput {
  width: number;
  height: number;
  axes: [x: string, y: string];
  range: Range;
  palette: Palette;
  lines: () => Drawn[];
  /** The line that stands out. */
  marked: () => string | null;
  onPoint: (point: Found | null) => void;
}

/** A point of a line, nearest to something. */
export interface Found {
  line: Drawn;
  index: number;
}

/** The picture is drawn anew when the range has rested for so long [ms], or for some drawings of it. */
const REST = 90;
const DRAWINGS = 4;
const FONT = "12px system-ui, sans-serif";
/** The cursor finds points no further away than this [px]. */
const REACH = 40;
/** Part by which a turn of the wheel zooms. */
const ZOOM = 1.2;

/** The range that shows all points; zero belongs to it where all are positive. */
export function rangeOf(lines: Line[]): Range {
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { x, y, band } of lines) {
    for (let index = 0; index < x.length; index++) {
      const [place = NaN, value = NaN] = [x[index], y[index]];
      if (place < x0) x0 = place;
      if (place > x1) x1 = place;
      const [low = value, high = value] = [band?.low[index], band?.high[index]];
      if (low < y0) y0 = low;
      if (high > y1) y1 = high;
    }
  }
  if (!(x1 >= x0)) return { x: [0, 1], y: [0, 1] };
  return { x: widened(x0, x1, 0.01), y: widened(Math.min(0, y0), Math.max(0, y1), 0.05) };
}

function widened(low: number, high: number, part: number): [number, number] {
  const room = (high - low || Math.abs(high) || 1) * part;
  return [low === 0 ? 0 : low - room, high + room];
}

/** A plot that draws its lines by itself; `redraw` after they have changed. */
export class ManyPlot {
  readonly plot: uPlot;
  /** How long the last whole drawing took [ms]. */
  took = 0;
  readonly #input: ManyInput;
  #picture: { canvas: HTMLCanvasElement; range: Range } | null = null;
  #rest: ReturnType<typeof setTimeout> | undefined;
  #isMoving = false;

  constructor(input: ManyInput, host: HTMLElement) {
    this.#input = input;
    const { range, palette, axes } = input;
    const data: uPlot.AlignedData = [range.x, range.y];
    this.plot = new uPlot(
      {
        width: input.width,
        height: input.height,
        padding: [14, 18, 0, 0],
        legend: { show: false },
        cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false } },
        scales: {
          x: { time: false, range: (_, low, high) => this.#ranged("x", low, high) },
          y: { range: (_, low, high) => this.#ranged("y", low, high) },
        },
        axes: [axis(axes[0], palette, { side: 2, size: 34, space: 42 }), axis(axes[1], palette, { side: 3, size: 60 })],
        series: [{}, { scale: "y", paths: () => null, points: { show: false } }],
        hooks: {
          drawSeries: [() => this.#draw()],
          setScale: [() => this.#move()],
          setCursor: [() => this.#find()],
          ready: [(plot) => plot.over.addEventListener("wheel", (event) => this.#turn(event), { passive: false })],
        },
      },
      data,
      host,
    );
  }

  /** Draws all lines anew, in the present range. */
  redraw(): void {
    this.#picture = null;
    this.plot.redraw(false);
  }

  resize(width: number, height: number): void {
    this.#picture = null;
    this.plot.setSize({ width, height });
  }

  /** Shows this range, or all. */
  show(range: Range = this.#input.range): void {
    this.plot.batch(() => {
      this.plot.setScale("x", { min: range.x[0], max: range.x[1] });
      this.plot.setScale("y", { min: range.y[0], max: range.y[1] });
    });
  }

  get range(): Range {
    const { x, y } = this.plot.scales;
    return { x: [x?.min ?? 0, x?.max ?? 1], y: [y?.min ?? 0, y?.max ?? 1] };
  }

  destroy(): void {
    clearTimeout(this.#rest);
    this.plot.destroy();
  }

  /** A double click asks for all of the data; that is the range given, not that of two points. */
  #ranged(axis: "x" | "y", low: number | null, high: number | null): [number, number] {
    const { range } = this.#input;
    return low === null || high === null || low === high ? range[axis] : [low, high];
  }

  #move(): void {
    if (!this.#picture) return;
    this.#isMoving = true;
    clearTimeout(this.#rest);
    this.#rest = setTimeout(
      () => {
        this.#isMoving = false;
        this.redraw();
      },
      Math.max(REST, DRAWINGS * this.took),
    );
  }

  #turn(event: WheelEvent): void {
    event.preventDefault();
    const { over } = this.plot;
    const { left, top, width, height } = over.getBoundingClientRect();
    const factor = event.deltaY < 0 ? 1 / ZOOM : ZOOM;
    const at = [(event.clientX - left) / width, 1 - (event.clientY - top) / height];
    const around = ([low, high]: [number, number], part: number): [number, number] => {
      const centre = low + (high - low) * part;
      return [centre - (centre - low) * factor, centre + (high - centre) * factor];
    };
    const { x, y } = this.range;
    this.show({ x: around(x, at[0] ?? 0.5), y: around(y, at[1] ?? 0.5) });
  }

  #draw(): void {
    const { ctx, bbox } = this.plot;
    if (this.#isMoving && this.#picture) {
      stretch(ctx, bbox, this.#picture, this.range);
      return;
    }
    const begin = performance.now();
    const canvas = this.#picture?.canvas ?? document.createElement("canvas");
    [canvas.width, canvas.height] = [bbox.width, bbox.height];
    // In memory rather than on the graphics card: many thin lines are drawn faster there, and it is known
    // how long they took.
    const paper = canvas.getContext("2d", { willReadFrequently: true });
    if (!paper) return;
    const ratio = devicePixelRatio;
    drawLines(paper, this.#input.lines(), this.#input.marked(), this.range, this.#input.palette, ratio);
    this.#picture = { canvas, range: this.range };
    ctx.drawImage(canvas, bbox.left, bbox.top);
    this.took = performance.now() - begin;
  }

  #find(): void {
    const { left = -1, top = -1 } = this.plot.cursor;
    if (left < 0 || this.#isMoving) return void (left < 0 && this.#input.onPoint(null));
    const { over } = this.plot;
    const size: [number, number] = [over.clientWidth, over.clientHeight];
    this.#input.onPoint(nearest(this.#input.lines(), this.range, size, [left, top]));
  }
}

/** The last picture in the place where its range lies now. */
function stretch(
  ctx: CanvasRenderingContext2D,
  bbox: uPlot.BBox,
  { canvas, range }: { canvas: HTMLCanvasElement; range: Range },
  now: Range,
): void {
  const place = (value: number, [low, high]: [number, number], length: number): number =>
    ((value - low) / (high - low)) * length;
  const left = place(range.x[0], now.x, bbox.width);
  const right = place(range.x[1], now.x, bbox.width);
  const bottom = place(range.y[0], now.y, bbox.height);
  const top = place(range.y[1], now.y, bbox.height);
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.drawImage(canvas, bbox.left + left, bbox.top + bbox.height - top, right - left, top - bottom);
  ctx.restore();
}

/** Draws lines over the whole of a paper; the marked one last and strong, the others pale beside it. */
function drawLines(
  paper: CanvasRenderingContext2D,
  lines: Drawn[],
  marked: string | null,
  { x: [x0, x1], y: [y0, y1] }: Range,
  palette: Palette,
  ratio: number,
): void {
  const { width, height } = paper.canvas;
  const [sx, sy] = [width / (x1 - x0), height / (y1 - y0)];
  const many = lines.length > 60;
  paper.lineJoin = "bevel";
  const colours = new Map<string, string>();
  const colourOf = (name: string): string => {
    const known = colours.get(name) ?? (name.startsWith("--") ? palette(name) : name);
    colours.set(name, known);
    return known;
  };
  const path = (xs: ArrayLike<number>, ys: ArrayLike<number>, isBack = false): void => {
    for (let step = 0; step < xs.length; step++) {
      const index = isBack ? xs.length - 1 - step : step;
      paper.lineTo(((xs[index] ?? NaN) - x0) * sx, height - ((ys[index] ?? NaN) - y0) * sy);
    }
  };
  const order =
    marked === null ? lines : [...lines.filter(({ id }) => id !== marked), ...lines.filter(({ id }) => id === marked)];
  for (const line of order) {
    const isMarked = line.id === marked;
    paper.strokeStyle = colourOf(line.colour);
    paper.globalAlpha = marked !== null && !isMarked ? 0.3 : 1;
    paper.lineWidth = (isMarked ? 2.8 : line.isMeasured || line.band ? 2.4 : many ? 1 : 1.6) * ratio;
    paper.setLineDash(line.isMeasured ? [6 * ratio, 4 * ratio] : []);
    if (line.band) {
      paper.beginPath();
      path(line.x, line.band.low);
      path(line.x, line.band.high, true);
      paper.fillStyle = colourOf(line.colour);
      paper.globalAlpha *= 0.18;
      paper.fill();
      paper.globalAlpha /= 0.18;
    }
    paper.beginPath();
    path(line.x, line.y);
    paper.stroke();
  }
}

/** The point nearest to a place on the plot [px from the upper left]; null when none is near. */
export function nearest(
  lines: Drawn[],
  { x: [x0, x1], y: [y0, y1] }: Range,
  [width, height]: [number, number],
  [left, top]: [number, number],
): Found | null {
  const [sx, sy] = [width / (x1 - x0), height / (y1 - y0)];
  const [x, y] = [x0 + left / sx, y1 - top / sy];
  let found: Found | null = null;
  let least = REACH * REACH;
  for (const line of lines) {
    for (let index = 0; index < line.x.length; index++) {
      const across = ((line.x[index] ?? NaN) - x) * sx;
      if (across * across >= least) continue;
      const up = ((line.y[index] ?? NaN) - y) * sy;
      const distance = across * across + up * up;
      if (distance < least) [found, least] = [{ line, index }, distance];
    }
  }
  return found;
}

function axis(label: string, palette: Palette, place: Partial<uPlot.Axis>): uPlot.Axis {
  return {
    label,
    stroke: palette("--muted"),
    font: FONT,
    labelFont: FONT,
    labelSize: 18,
    grid: { stroke: palette("--line"), width: 1 },
    ticks: { stroke: palette("--line"), width: 1, size: 5 },
    values: (_, splits) => splits.map((split) => String(Number(split.toPrecision(6))).replace("-", "−")),
    ...place,
  };
}
