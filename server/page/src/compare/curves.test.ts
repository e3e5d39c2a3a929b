import { describe, expect, test } from "vitest";
import type { Differences } from "../api/types";
import { colouring, pointerLabel, ramp } from "./colours";
import { areaBetween, divisorOf, groupsOfSeeds, meanOf, scaledUnit, valueAt, type Line } from "./curves";

const line = (x: number[], y: number[]): Line => ({ id: "a", name: "a", x, y });

describe("values between points", () => {
  test("lie on the straight line, and there are none beyond the ends", () => {
    const tent = line([0, 1, 3], [0, 2, 0]);
    expect([-0.1, 0, 0.5, 1, 2, 3, 3.1].map((place) => valueAt(tent, place))).toEqual([NaN, 0, 1, 2, 1, 0, NaN]);
  });
  test("a fall at one abscissa has its last value", () => {
    expect(valueAt(line([0, 1, 1], [0, 2, 1]), 1)).toBe(1);
  });
});

describe("area between curves", () => {
  test("of parallel lines is length times distance", () => {
    expect(areaBetween(line([0, 2], [1, 1]), line([0, 1, 2], [4, 4, 4]))).toBe(6);
  });
  test("of lines that cross is that of two triangles", () => {
    // from -1 to +1 over 2: two triangles of 1/2 · 1 · 1
    expect(areaBetween(line([0, 2], [-1, 1]), line([0, 2], [0, 0]))).toBe(1);
  });
  test("counts what both reach, and is unknown where a curve turns back", () => {
    expect(areaBetween(line([0, 4], [1, 1]), line([1, 2], [0, 0]))).toBe(1);
    expect(areaBetween(line([0, 1, 0], [0, 1, 0]), line([0, 1], [0, 0]))).toBe(NaN);
  });
});

describe("mean over seeds", () => {
  test("has the standard deviation of single curves as its band", () => {
    const mean = meanOf([line([0, 1], [1, 1]), line([0, 2], [3, 3])], "m", "mean");
    // (1 + 3) / 2 = 2; √(((1 − 2)² + (3 − 2)²) / 1) = √2
    expect(mean?.y[0]).toBe(2);
    expect(mean?.band?.high[7]).toBeCloseTo(2 + Math.SQRT2, 12);
    expect(mean?.x[399]).toBe(1);
  });
  test("is not taken of one curve, of loops, or of curves without a common range", () => {
    expect(meanOf([line([0, 1], [1, 1])], "m", "m")).toBeNull();
    expect(meanOf([line([0, 1, 0], [1, 1, 1]), line([0, 1], [1, 1])], "m", "m")).toBeNull();
    expect(meanOf([line([0, 1], [1, 1]), line([2, 3], [1, 1])], "m", "m")).toBeNull();
  });
});

const job = (id: string): Differences["jobs"][number] => ({
  id,
  kind: "paper_tensile",
  name: id,
  tags: [],
  status: "finished",
  outcome: "succeeded",
  created_at: "2026-11-26T00:00:00Z",
  spec_sha256: id,
  columns: ["nominal_strain", "force_n"],
  points: 2,
  dimensions: { width_mm: 5 },
});

const differences: Differences = {
  jobs: ["a", "b", "c", "d"].map(job),
  fields: [
    { pointer: "/spec/seed", values: [1, 2, 1, 3] },
    { pointer: "/spec/bond/modulus_n", unit: "N", values: [1, 1, 2, 1] },
  ],
  fields_left_out: 0,
  specs_left_out: [],
  results: [],
  missing: [],
  more: false,
};

test("jobs that differ by the seed alone are a group", () => {
  expect(groupsOfSeeds(differences)).toEqual([[0, 1, 3], [2]]);
  expect(groupsOfSeeds({ ...differences, specs_left_out: ["b", "d"] })).toEqual([[0], [1], [2], [3]]);
});

test("ordinates are divided by what is known of the specimen", () => {
  expect(divisorOf("width", job("a"), [])).toBe(5);
  expect(divisorOf("grammage", job("a"), [])).toBeNull();
  expect(divisorOf("maximum", job("a"), [1, 4, 2])).toBe(4);
  expect(divisorOf("maximum", job("a"), [0, 0])).toBeNull();
  expect(scaledUnit("N", "width")).toBe("N/mm");
  expect(scaledUnit("N", "grammage")).toBe("N/(g/m²)");
});

test("few values have colours of their own, many a ramp", () => {
  const [, modulus] = differences.fields;
  const quality = { key: "k", label: "modulus", unit: "N", values: modulus?.values ?? [] };
  const few = colouring(quality, []);
  expect(few.colours).toEqual(["--series-1", "--series-1", "--series-2", "--series-1"]);
  expect(few.legend.map(({ text }) => text)).toEqual(["1\u202fN", "2\u202fN"]);
  const many = colouring({ ...quality, values: [...Array(9).keys(), null] }, []);
  expect(many.isRamp).toBe(true);
  expect([many.colours[0], many.colours[8], many.colours[9]]).toEqual([ramp(0), ramp(1), "--muted"]);
});

test("pointers read as the guide writes fields", () => {
  expect(pointerLabel("/spec/bond/modulus_n")).toBe("bond.modulus_n");
  expect(pointerLabel("/kind")).toBe("kind");
});
