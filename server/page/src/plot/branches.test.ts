import { describe, expect, it } from "vitest";
import { branchesOf, orderAlong } from "./branches";

describe("the order along an axis", () => {
  it("is that of time while the curve goes right", () => {
    expect(orderAlong([0, 1, 1, 3])).toEqual({ rows: [0, 1, 2, 3], turnsBack: false });
  });
  it("ascends where the curve turns back, equal values in the order of time", () => {
    expect(orderAlong([0, 2, 5, 4, 2, 6])).toEqual({ rows: [0, 1, 4, 3, 2, 5], turnsBack: true });
  });
  it("leaves out rows without a value", () => {
    expect(orderAlong([NaN, 1, NaN, 0])).toEqual({ rows: [3, 1], turnsBack: true });
  });
});

describe("the branches", () => {
  it("of two cycles are four that hang together", () => {
    expect(branchesOf(7, [1, 1, 1, 1, 2, 2, 2], [0, 0, 1, 1, 0, 0, 1])).toEqual([
      { first: 0, last: 1, cycle: 1, isUnloading: false },
      { first: 1, last: 3, cycle: 1, isUnloading: true },
      { first: 3, last: 5, cycle: 2, isUnloading: false },
      { first: 5, last: 6, cycle: 2, isUnloading: true },
    ]);
  });
  it("of a curve that knows no cycles are one", () => {
    expect(branchesOf(3, undefined, undefined)).toEqual([{ first: 0, last: 2, cycle: 1, isUnloading: false }]);
  });
});
