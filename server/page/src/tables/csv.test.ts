import { expect, test } from "vitest";
import { numbers, parseCsv, words } from "./csv";

test("a table keeps its cells, and what is not known is no number", () => {
  const table = parseCsv("stage,phase,bed_porosity\n1,pour,0.5\n2,settle,\n3,cut,-1e-7\n");
  expect(table.columns).toEqual(["stage", "phase", "bed_porosity"]);
  expect(words(table, "phase")).toEqual(["pour", "settle", "cut"]);
  expect(numbers(table, "bed_porosity")).toEqual([0.5, NaN, -1e-7]);
  expect(numbers(table, "salt")).toBeUndefined();
});

test("a table without rows is still a table", () => {
  expect(parseCsv("cycle,force_n\n")).toEqual({ columns: ["cycle", "force_n"], rows: [] });
});
