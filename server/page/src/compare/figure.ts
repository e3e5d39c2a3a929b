// The plot as a figure for a paper: SVG, and PNG made from it.
import type { colouring } from "./colours";
import type { Drawn, Range } from "./manyPlot";

export interface FigureInput {
  lines: Drawn[];
  range: Range;
  axes: [x: string, y: string];
  legend: ReturnType<typeof colouring>["legend"];
  legendTitle: string;
  /** Gives the colour behind a name such as `--series-1`. */
  palette: (name: string) => string;
}

const WIDTH = 900;
const HEIGHT = 560;
const LEFT = 78;
const RIGHT = 24;
const TOP = 20;
const BOTTOM = 56;
const LEGEND_WIDTH = 220;
const LINE = 18;
/** Figures of papers are printed at 300 dots an inch or more: three times the size on screen. */
const PNG_SCALE = 3;
/** Most lines of a legend. */
const MOST_ENTRIES = 24;

/** Round numbers within a range, about `count` of them. */
export function ticksOf([low, high]: [number, number], count: number): number[] {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((one) => one >= rough * 0.999) ?? power;
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

/** The figure as SVG, on white paper, with texts as texts. */
export function svgOf({ lines, range, axes, legend, legendTitle, palette }: FigureInput): string {
  const hasLegend = legend.length > 0;
  const width = WIDTH + (hasLegend ? LEGEND_WIDTH : 0);
  const [w, h] = [WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM];
  const px = (x: number): number => LEFT + ((x - range.x[0]) / (range.x[1] - range.x[0])) * w;
  const py = (y: number): number => TOP + h - ((y - range.y[0]) / (range.y[1] - range.y[0])) * h;
  const colour = (name: string): string => escaped(name.startsWith("--") ? palette(name) : name);
  const points = (xs: ArrayLike<number>, ys: ArrayLike<number>): string[] =>
    Array.from({ length: xs.length }, (_, index) => `${round(px(xs[index] ?? NaN))},${round(py(ys[index] ?? NaN))}`);
  const grid = [
    ...ticksOf(range.x, 8).map((x) => tick(px(x), TOP + h, px(x), TOP, px(x), TOP + h + 18, "middle", x)),
    ...ticksOf(range.y, 6).map((y) => tick(LEFT, py(y), LEFT + w, py(y), LEFT - 8, py(y) + 4, "end", y)),
  ];
  const drawn = lines.map((line) => {
    const stroke = colour(line.colour);
    const band = line.band
      ? `<polygon fill="${stroke}" fill-opacity="0.18" points="${[
          ...points(line.x, line.band.low),
          ...points(line.x, line.band.high).toReversed(),
        ].join(" ")}"/>`
      : "";
    const dash = line.isMeasured ? ' stroke-dasharray="6 4"' : "";
    const strong = line.isMeasured || line.band ? 2.4 : 1.4;
    const title = `<title>${escaped(line.name)}</title>`;
    return `${band}<polyline fill="none" stroke="${stroke}" stroke-width="${strong}"${dash} points="${points(line.x, line.y).join(" ")}">${title}</polyline>`;
  });
  const entries = legend.slice(0, MOST_ENTRIES).map(({ colour: name, text }, index) => {
    const y = TOP + LINE * (index + 2);
    return `<line x1="${WIDTH}" x2="${WIDTH + 22}" y1="${y - 4}" y2="${y - 4}" stroke="${colour(name)}" stroke-width="3"/><text x="${WIDTH + 30}" y="${y}">${escaped(text)}</text>`;
  });
  const title = hasLegend ? `<text x="${WIDTH}" y="${TOP + 12}" font-weight="600">${escaped(legendTitle)}</text>` : "";
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${HEIGHT}" viewBox="0 0 ${width} ${HEIGHT}" font-family="Helvetica, Arial, sans-serif" font-size="13">
<rect width="${width}" height="${HEIGHT}" fill="#ffffff"/>
<clipPath id="inside"><rect x="${LEFT}" y="${TOP}" width="${w}" height="${h}"/></clipPath>
<g>${grid.join("")}</g>
<g clip-path="url(#inside)" stroke-linejoin="round">${drawn.join("\n")}</g>
<rect x="${LEFT}" y="${TOP}" width="${w}" height="${h}" fill="none" stroke="#444444"/>
<text x="${LEFT + w / 2}" y="${HEIGHT - 14}" text-anchor="middle">${escaped(axes[0])}</text>
<text transform="translate(18 ${TOP + h / 2}) rotate(-90)" text-anchor="middle">${escaped(axes[1])}</text>
${title}${entries.join("")}
</svg>`;
}

function tick(
  x1: number,
  y1: number,
  x2: number,
  y2: number,
  x: number,
  y: number,
  anchor: string,
  value: number,
): string {
  const line = `<line x1="${round(x1)}" y1="${round(y1)}" x2="${round(x2)}" y2="${round(y2)}" stroke="#dddddd"/>`;
  const text = String(value).replace("-", "−");
  return `${line}<text x="${round(x)}" y="${round(y)}" text-anchor="${anchor}">${text}</text>`;
}

function round(place: number): number {
  return Math.round(place * 100) / 100;
}

/** A text in XML: whatever a person called a job is only ever a text. */
export function escaped(text: string): string {
  const marks: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };
  // Characters that XML does not know are left out.
  // eslint-disable-next-line no-control-regex
  return text.replace(/[&<>"']/g, (mark) => marks[mark] ?? "").replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f]/g, "");
}

/** The figure as PNG. */
export async function pngOf(svg: string): Promise<Blob> {
  const image = new Image();
  const address = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  try {
    image.src = address;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = image.width * PNG_SCALE;
    canvas.height = image.height * PNG_SCALE;
    canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
    const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
    if (!blob) throw new Error("The browser made no picture.");
    return blob;
  } finally {
    URL.revokeObjectURL(address);
  }
}

/** Hands a file to the person. */
export function save(name: string, content: Blob): void {
  const address = URL.createObjectURL(content);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
