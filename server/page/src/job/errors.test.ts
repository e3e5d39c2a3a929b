import { expect, test } from "vitest";
import type { Quantity } from "../api/types";
import { NARROW } from "../format/numbers";
import { formatDuration } from "../format/time";
import { tabbed } from "./copied";
import { errorTable } from "./errors";

const DEFLECTION: Quantity = {
  value: 0.052366,
  unit: "mm",
  error: {
    value: 8.2e-5,
    parts: [
      {
        source: "grid",
        value: 8.136e-5,
        basis: "two_grids",
        tenth: { change: "grid.cells [800, 400]", time_factor: 240 },
      },
      { source: "solver", value: 1.2e-6, basis: "two_solvers" },
    ],
  },
};
const STRAIN: Quantity = {
  value: 0.0123,
  unit: "1",
  error: {
    value: 0.00041,
    parts: [
      { source: "time_step", value: 0.0004, basis: "measured_table" },
      { source: "time_step", value: 0.00009, basis: "propagated" },
    ],
  },
};
const LOAD: Quantity = {
  value: 10,
  unit: "N",
  error: { value: 0, parts: [{ source: "grid", value: 0, basis: "two_grids" }] },
};
const CELLS: Quantity = { value: 11400, unit: "1" };

test("each source of an error has a column, in the units that the results are shown in", () => {
  const { sources, rows, tenths } = errorTable(
    [
      ["mean_top_deflection", DEFLECTION],
      ["mean_bottom_deflection", DEFLECTION],
      ["max_strain", STRAIN],
      ["max_force", LOAD],
      ["cells", CELLS],
    ],
    0.5,
  );
  // told once, not for every result
  expect(tenths).toEqual([{ source: "Grid", change: "grid.cells [800, 400]", time: formatDuration(120) }]);
  expect(sources).toEqual([
    { source: "Grid", basis: "from coarser grids" },
    { source: "Solver", basis: "from another solver" },
    { source: "Time step", basis: "from a measured table" },
    { source: "Time step", basis: "by that of another result" },
  ]);
  // what was given, such as a load, cannot be wrong
  expect(rows).toEqual([
    { name: "mean_top_deflection", parts: [`0.000081${NARROW}mm`, `0.0000012${NARROW}mm`, "", ""] },
    { name: "mean_bottom_deflection", parts: [`0.000081${NARROW}mm`, `0.0000012${NARROW}mm`, "", ""] },
    { name: "max_strain", parts: ["", "", `0.04${NARROW}%`, `0.009${NARROW}%`] },
  ]);
});

test("without errors there is nothing to tell", () => {
  expect(errorTable([["cells", CELLS]], 1)).toEqual({ sources: [], rows: [], tenths: [] });
});

test("a copied table has all digits, and empty cells where nothing is known", () => {
  const repeated: Quantity = { value: 2, unit: "N", deviation: 0.25, n: 5 };
  expect(
    tabbed([
      ["mean_top_deflection", DEFLECTION],
      ["strength", repeated],
      ["late", { value: null, unit: "J", reason: "it had parted before" }],
    ]).split("\n"),
  ).toEqual([
    "name\tvalue\tunit\tdeviation\tn\terror\treason",
    "mean_top_deflection\t0.052366\tmm\t\t\t0.000082\t",
    "strength\t2\tN\t0.25\t5\t\t",
    "late\t\tJ\t\t\t\tit had parted before",
  ]);
});
