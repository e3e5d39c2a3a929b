import { expect, test } from "vitest";
import { byDirection } from "./directions";

const quantity = (value: number, unit = "N") => ({ value, unit, description: "words" });

test("a test in one direction has one value in each row", () => {
  const { second, rows } = byDirection([
    ["max_force", quantity(1)],
    ["nodes", quantity(2, "1")],
  ]);
  expect(second).toBe(null);
  expect(rows.map(({ name, shown }) => [name, shown.length])).toEqual([
    ["max_force", 1],
    ["nodes", 1],
  ]);
});

test("the second direction stands beside the first, and ratios alone", () => {
  const { second, rows } = byDirection([
    ["max_force", quantity(1)],
    ["max_force_along_x", quantity(3)],
    ["anisotropy_of_strength", quantity(0.5, "1")],
  ]);
  expect(second).toBe("x");
  expect(rows.map(({ name, shown }) => [name, shown.map(({ text }) => text)])).toEqual([
    ["max_force", ["1", "3"]],
    ["anisotropy_of_strength", ["0.5000"]],
  ]);
});

test("a name that ends like a direction without a first is a result of its own", () => {
  const { second, rows } = byDirection([["drift_along_x", quantity(1)]]);
  expect(second).toBe(null);
  expect(rows[0]?.name).toBe("drift_along_x");
});
