import { deflateSync } from "node:zlib";
import { expect, test } from "vitest";
import type { Job } from "../api/types";
import { NARROW } from "../format/numbers";
import { colourOf, rampOf, rangeOf } from "./colours";
import { boundsOf, framesOf, inventory, pictureOf, scalarsOf, usualScalars } from "./frames";
import { momentOf, subjectOf } from "./subject";
import { readVtp, type PolyData } from "./vtp";

/** An array as the engine appends it, in blocks of so many bytes. */
function appended(values: Float64Array | Int32Array | Uint8Array, block: number): Uint8Array {
  const bytes = new Uint8Array(values.buffer);
  const blocks: Uint8Array[] = [];
  for (let at = 0; at < bytes.length; at += block) blocks.push(deflateSync(bytes.subarray(at, at + block)));
  const head = [blocks.length, block, bytes.length % block, ...blocks.map(({ length }) => length)];
  return Buffer.concat([new Uint8Array(BigUint64Array.from(head.map(BigInt)).buffer), ...blocks]);
}

type Arrays = [name: string, components: number, values: Float64Array | Int32Array | Uint8Array][];

function vtp(sections: Record<string, Arrays>): ArrayBuffer {
  let offset = 0;
  const data: Uint8Array[] = [];
  const text = Object.entries(sections).map(([section, arrays]) => {
    const elements = arrays.map(([name, components, values]) => {
      const type = values instanceof Float64Array ? "Float64" : values instanceof Int32Array ? "Int32" : "UInt8";
      const element = `<DataArray type="${type}" Name="${name}" NumberOfComponents="${components}" format="appended" offset="${offset}"/>`;
      const array = appended(values, 40);
      offset += array.length;
      data.push(array);
      return element;
    });
    return `<${section}>${elements.join("")}</${section}>`;
  });
  const header = `<?xml version="1.0"?><VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="3">${text.join("\n")}</Piece></PolyData><AppendedData encoding="raw">_`;
  return new Uint8Array(Buffer.concat([Buffer.from(header), ...data])).buffer;
}

const SPHERES = vtp({
  PointData: [
    ["radius_m", 1, Float64Array.of(0.1, 0.2, 0.3)],
    ["velocity_m_per_s", 3, Float64Array.of(3, 4, 0, 0, 0, 0, 0, 0, 2)],
    ["fragment", 1, Int32Array.of(0, 0, 7)],
  ],
  CellData: [],
  Points: [["Points", 3, Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, -1e-9)]],
});
const WALLS = vtp({
  CellData: [["wall", 1, Int32Array.of(0)]],
  Points: [["Points", 3, Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0)]],
  Polys: [
    ["connectivity", 1, Int32Array.of(0, 1, 2)],
    ["offsets", 1, Int32Array.of(3)],
  ],
});
const BONDS = vtp({
  CellData: [
    ["force_n", 1, Float64Array.of(1, 5)],
    ["broken", 1, Uint8Array.of(0, 1)],
  ],
  Points: [["Points", 3, Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0)]],
  Lines: [
    ["connectivity", 1, Int32Array.of(0, 1, 1, 2)],
    ["offsets", 1, Int32Array.of(2, 4)],
  ],
});
/** Two cells of a section, each with corners of its own. */
const CELLS = vtp({
  PointData: [["displacement_mm", 3, new Float64Array(24).fill(1)]],
  CellData: [
    ["fibre_share", 1, Float64Array.of(0, 1)],
    ["strain_xx", 1, Float64Array.of(-0.001, 0.002)],
    ["stress_mises_mpa", 1, Float64Array.of(3, 4)],
  ],
  Points: [["Points", 3, Float64Array.of(0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0, 1, 0, 0, 4, 0, 0, 4, 2, 0, 1, 2, 0)]],
  Polys: [
    ["connectivity", 1, Int32Array.of(0, 1, 2, 3, 4, 5, 6, 7)],
    ["offsets", 1, Int32Array.of(4, 8)],
  ],
});
const read = (...files: ArrayBuffer[]): Promise<PolyData[]> => Promise.all(files.map(readVtp));

test("a snapshot is read over several blocks, to the last bit", async () => {
  const [spheres] = await read(SPHERES);
  expect([...(spheres?.points ?? [])]).toEqual([0, 0, 0, 1, 0, 0, 0, 1, -1e-9]);
  expect(spheres?.pointData.map(({ name, values }) => [name, values.length])).toEqual([
    ["radius_m", 3],
    ["velocity_m_per_s", 9],
    ["fragment", 3],
  ]);
});

test("bodies are coloured by their fragments, and vectors by their size", async () => {
  const [spheres] = await read(SPHERES);
  const scalars = scalarsOf(spheres?.pointData ?? []);
  expect(usualScalars(scalars)).toBe("fragment");
  expect(scalars[0]).toMatchObject({ label: "Velocity", unit: "m/s", isCategory: false, values: [5, 0, 2] });
  expect(scalars[0] && rangeOf(scalars[0])).toEqual([0, 5]);
});

test("what a snapshot holds is said, and also what it does not", async () => {
  expect(inventory(pictureOf(await read(SPHERES, WALLS)), "scene")).toBe("3 spheres and 1 polygon of walls.");
  expect(inventory(pictureOf(await read(WALLS, BONDS)), "fabric")).toBe(
    "1 polygon of walls, 1 bond and 1 broken bond.",
  );
  expect(inventory(pictureOf(await read(WALLS)), "scene")).toBe("1 polygon of walls. No bodies are recorded in it.");
  const none = new Int32Array();
  const radii = { name: "radius_m", components: 1, values: new Float64Array(20_000) };
  const many = {
    points: new Float64Array(60_000),
    lines: none,
    corners: none,
    ends: none,
    pointData: [radii],
    cellData: [],
  };
  expect(inventory(pictureOf([many]), "scene")).toBe(`20${NARROW}000 spheres.`);
  expect(inventory(pictureOf([]), "scene")).toBe("Nothing is recorded in this snapshot.");
});

test("polygons with stresses are a body, and coloured by them", async () => {
  const picture = pictureOf(await read(CELLS));
  expect([picture.walls, picture.cells?.ends.length]).toEqual([undefined, 2]);
  expect(inventory(picture, "loaded section")).toBe("2 cells.");
  expect(picture.cells && boundsOf(picture.cells)).toEqual({ low: [0, 0, 0], high: [4, 2, 0] });
  const scalars = scalarsOf(picture.cells?.cellData ?? []);
  expect(usualScalars(scalars)).toBe("stress_mises_mpa");
  // the paper's lattice has no stresses
  expect(usualScalars(scalars.slice(0, 2))).toBe("strain_xx");
});

test("the peak at a corner leaves colours to the rest", () => {
  const values = Float64Array.from({ length: 201 }, (_, index) => index / 100);
  values[200] = 50;
  const stress = { name: "s", label: "Stress", unit: "MPa", isCategory: false, values };
  expect([rangeOf(stress), rampOf(stress)]).toEqual([
    [0, 50],
    [0, 50],
  ]);
  expect(rampOf({ ...stress, hasOutliers: true })).toEqual([0.02, 1.98]);
  const colours = colourOf({ ...stress, hasOutliers: true }, 201);
  // what lies beyond an end has its colour
  expect(colours.slice(600)).toEqual(colours.slice(594, 597));
  // with a share of fibre in few cells, the ramp is for these
  const thin = {
    ...stress,
    hasOutliers: true,
    values: Float64Array.from({ length: 201 }, (_, index) => +(index === 7)),
  };
  expect(rampOf(thin)).toEqual([0, 1]);
});

test("moments are told in what they are counted in", () => {
  const told = (kind: string, at: number, spec: unknown = {}): string => {
    const text = momentOf(at, subjectOf({ kind, spec } as Job));
    return text.replaceAll(NARROW, " ");
  };
  expect(told("granular_scene", 0.25)).toBe("0.2500 s");
  expect(told("ballast_box", 0.25)).toBe("0.2500 s");
  expect(told("a_kind_of_tomorrow", 0.25)).toBe("at 0.2500");
  expect(told("nonwoven_tensile", 0.25)).toBe("25 % strain");
  expect(told("paper_tensile", 0.02, { specimen: { sheet: {} } })).toContain("strain");
  expect(told("composite_cell", 1)).toContain("1 MPa");
  expect(told("composite_bending", 0.5, { test: { breaking: {} } })).toContain("mm");
  expect(told("composite_bending", 1)).toBe("full load");
  expect(told("composite_bending", 0.5)).toBe("50 % of the load");
  expect(told("composite_bending", 1, { test: { history: { load: "released" } } })).toBe("at the end");
});

test("a file of another form is refused in words", async () => {
  await expect(readVtp(new TextEncoder().encode("<VTKFile/>").buffer)).rejects.toThrow("not in the form");
});

test("a file that was cut, changed or made up is read or refused, and leaves nothing running", async () => {
  let state = 36;
  const chance = (below: number): number => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
  const unhandled: unknown[] = [];
  const note = (reason: unknown): number => unhandled.push(reason);
  process.on("unhandledRejection", note);
  let refused = 0;
  for (let number = 0; number < 1200; number++) {
    const whole = new Uint8Array([SPHERES, WALLS, BONDS, CELLS][number % 4] ?? SPHERES);
    const mutant = number % 3 === 0 ? whole.slice(0, chance(whole.length)) : whole.slice();
    for (let change = chance(4); change >= 0 && mutant.length > 0; change--)
      mutant[chance(mutant.length)] = chance(256);
    try {
      const { points, lines } = await readVtp(mutant.buffer);
      expect(points.length + lines.length).toBeLessThan(1000);
    } catch (error) {
      if (!(error instanceof Error)) throw error;
      refused++;
    }
  }
  await new Promise((done) => setTimeout(done, 50));
  process.off("unhandledRejection", note);
  expect(unhandled).toEqual([]);
  expect(refused).toBeGreaterThan(600);
});

test("files of one moment are one picture, whichever list names them", () => {
  const set = (at: string, file: string): string => `<DataSet timestep="${at}" part="0" file="${file}"/>`;
  const frames = framesOf([
    set("0", "a_0.vtp") + set("0.5", "a_1.vtp") + set("0.5", "walls_1.vtp"),
    set("0.50", "contacts_1.vtp"),
  ]);
  expect(frames).toEqual([
    { at: 0, files: ["a_0.vtp"] },
    { at: 0.5, files: ["a_1.vtp", "walls_1.vtp", "contacts_1.vtp"] },
  ]);
});
