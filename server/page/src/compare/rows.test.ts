import { expect, test } from "vitest";
import type { Differences } from "../api/types";
import { columnsOf, csvOf, ordered } from "./rows";

const job = (id: string, name: string): Differences["jobs"][number] => ({
  id,
  kind: "paper_tensile",
  name,
  tags: [],
  status: "finished",
  outcome: "succeeded",
  created_at: "2026-11-26T00:00:00Z",
  spec_sha256: id,
  columns: ["nominal_strain", "force_n"],
  points: 2,
  dimensions: {},
});

const differences: Differences = {
  jobs: [job("a", "first"), job("b", '=2+3,"x"'), job("c", "third")],
  fields: [{ pointer: "/spec/bond/modulus_n", unit: "N", values: [2, null, 1] }],
  fields_left_out: 0,
  specs_left_out: [],
  results: [
    { name: "max_force", unit: "N", values: [10, 12.5, null] },
    { name: "stretch", unit: "1", values: [0.02, 0.03, 0.01] },
  ],
  missing: [],
  more: false,
};
const line = (id: string, height: number) => ({ id, name: id, x: [0, 2], y: [height, height] });

test("results stand in a lab's units, with the difference to the reference as a part of it", () => {
  const columns = columnsOf(differences, [line("a", 1), line("b", 4)], "a", "N");
  expect(columns.map(({ label, unit }) => `${label} [${unit}]`)).toEqual([
    "bond.modulus_n [N]",
    "Max force [N]",
    "Δ Max force [%]",
    "Stretch [%]",
    "Δ Stretch [%]",
    "Area between the curves [N]",
  ]);
  const texts = columns.map(({ cells }) => cells.map(({ text }) => text));
  // (12.5 − 10) / 10 = 25 %; (0.03 − 0.02) / 0.02 = 50 %; (4 − 1) · 2 = 6
  expect(texts[2]).toEqual(["0", "+25", "–"]);
  expect(texts[3]).toEqual(["2", "3", "1"]);
  expect(texts[5]).toEqual(["0", "6", "–"]);
});

test("rows without a value come last, whichever way they are sorted", () => {
  const [modulus] = columnsOf(differences, [], "", "");
  expect(ordered(modulus, 3, false)).toEqual([2, 0, 1]);
  expect(ordered(modulus, 3, true)).toEqual([0, 2, 1]);
  expect(ordered(undefined, 3, false)).toEqual([0, 1, 2]);
});

test("CSV has full digits, and names are no formulas", () => {
  const text = csvOf(differences.jobs, [], differences);
  expect(text.split("\n")).toEqual([
    "job,name,/spec/bond/modulus_n,max_force [N],stretch [1]",
    "a,first,2,10,0.02",
    `b,"'=2+3,""x""",,12.5,0.03`,
    "c,third,1,,0.01",
    "",
  ]);
});
