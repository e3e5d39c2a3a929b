// The moments of a test of which there are snapshots, and what can be seen of each.
import { formatNumber } from "../format/numbers";
import { describe } from "../plot/names";
import type { Subject } from "./subject";
import type { PolyData, Values } from "./vtp";

export interface Frame {
  /** Time of a scene [s], nominal strain of a fabric, or share of a section's load. */
  at: number;
  files: string[];
}

/** Moments of several series (`.pvd`) together; files of one moment are one picture. */
export function framesOf(series: string[]): Frame[] {
  const frames = new Map<number, string[]>();
  for (const [, at, file = ""] of series.flatMap((text) => [
    ...text.matchAll(/<DataSet timestep="([^"]+)"[^>]* file="([^"]+)"/g),
  ])) {
    frames.set(Number(at), [...(frames.get(Number(at)) ?? []), file]);
  }
  return [...frames].map(([at, files]) => ({ at, files })).toSorted((a, b) => a.at - b.at);
}

/** The parts of one picture, told apart by what they are made of. */
export interface Picture {
  spheres: PolyData | undefined;
  lines: PolyData | undefined;
  walls: PolyData | undefined;
  /** Polygons that are the body itself, with what is known of each. */
  cells: PolyData | undefined;
}

export function pictureOf(parts: PolyData[]): Picture {
  return {
    spheres: parts.find(
      ({ points, lines, ends, pointData }) =>
        points.length > 0 && lines.length + ends.length === 0 && pointData.some(({ name }) => name === "radius_m"),
    ),
    lines: parts.find(({ lines }) => lines.length > 0),
    walls: parts.find((part) => part.ends.length > 0 && !isBody(part)),
    cells: parts.find((part) => part.ends.length > 0 && isBody(part)),
  };
}

/** Walls have numbers, and cells have none. */
function isBody({ cellData }: PolyData): boolean {
  return cellData.length > 0 && !cellData.some(({ name }) => name === "wall");
}

/** Lowest and highest x, y and z of all points; nothing when there is no point. */
export function boundsOf({ points }: PolyData): { low: number[]; high: number[] } | undefined {
  if (points.length === 0) return undefined;
  const [low, high] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  points.forEach((value, index) => {
    low[index % 3] = Math.min(low[index % 3] ?? value, value);
    high[index % 3] = Math.max(high[index % 3] ?? value, value);
  });
  return { low, high };
}

/** What a picture holds, as a sentence. */
export function inventory({ spheres, lines, walls, cells }: Picture, subject: Subject): string {
  const isScene = subject === "scene";
  const broken = lines ? [...brokenOf(lines)].filter((is) => is > 0).length : 0;
  const bonds = lines && subject === "sheet" ? bondsOf(lines) : 0;
  const parts = lines ? lines.lines.length / 2 - broken - bonds : 0;
  const some = [
    count(spheres ? spheres.points.length / 3 : 0, "sphere"),
    count(cells?.ends.length ?? 0, "cell"),
    count(walls?.ends.length ?? 0, "polygon", " of walls"),
    count(parts, PARTS[subject] ?? "bond"),
    count(bonds, "bond"),
    count(broken, subject === "sheet" ? "break" : "broken bond"),
  ].filter((text) => text !== "");
  if (some.length === 0) return "Nothing is recorded in this snapshot.";
  const list = some.length > 1 ? `${some.slice(0, -1).join(", ")} and ${some.at(-1)}` : some.join();
  return `${list}.${isScene && !spheres ? " No bodies are recorded in it." : ""}`;
}

/** What a line is called that is no bond. */
const PARTS: Partial<Record<Subject, string>> = {
  picture: "line",
  scene: "contact force",
  sheet: "segment",
  fibre: "spring",
};

/** Lines of a sheet that are whole bonds. */
function bondsOf(lines: PolyData): number {
  const isBond = lines.cellData.find(({ name }) => name === "is_bond")?.values ?? new Uint8Array();
  const broken = brokenOf(lines);
  return [...isBond].filter((is, line) => is > 0 && !(broken[line] ?? 0)).length;
}

/** For each line whether it has broken; empty where lines do not break. */
export function brokenOf({ cellData }: PolyData): Values["values"] {
  return cellData.find(({ name }) => name === "broken")?.values ?? new Uint8Array();
}

function count(number: number, what: string, rest = ""): string {
  return number === 0 ? "" : `${formatNumber(number)} ${what}${number === 1 ? "" : "s"}${rest}`;
}

/** What bodies, lines or cells can be coloured by: single values, and the size of vectors. */
export interface Scalars {
  name: string;
  label: string;
  unit: string;
  /** Each value is a colour of its own, and no more or less than another. */
  isCategory: boolean;
  /** Few values lie so far out that colours leave them aside, such as stresses at the corner of a support. */
  hasOutliers?: boolean;
  values: ArrayLike<number>;
}

const NAMES = ["fragment", "body", "grain", "clump", "material"];

export function scalarsOf(data: Values[]): Scalars[] {
  return data
    .filter(({ name }) => name !== "radius_m" && name !== "broken")
    .map(({ name, components, values }) => ({
      name,
      label: describe(name).label,
      unit: describe(name).unit,
      isCategory: NAMES.includes(name),
      values:
        components === 1
          ? values
          : Array.from({ length: values.length / components }, (_, row) =>
              Math.hypot(...values.subarray(row * components, (row + 1) * components)),
            ),
    }));
}

/** Those that are not the same everywhere. */
export function tellingScalars(all: Scalars[]): Scalars[] {
  return all.filter(({ values }) => {
    for (let place = 1; place < values.length; place++) if (values[place] !== values[0]) return true;
    return false;
  });
}

/** The one that tells most when nobody has chosen: pieces, where grains break. */
export function usualScalars(all: Scalars[]): string {
  const known = [
    "fragment",
    "velocity_m_per_s",
    "normal_force_n",
    "force_over_strength",
    "stress_mises_mpa",
    "strain_xx",
  ];
  return known.find((name) => all.some((scalars) => scalars.name === name)) ?? all[0]?.name ?? "";
}
