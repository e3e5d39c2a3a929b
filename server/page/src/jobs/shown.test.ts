import { expect, test } from "vitest";
import type { Job } from "../api/types";
import {
  inOrder,
  labelOf,
  pressed,
  readShown,
  resultNames,
  resultOf,
  sortOf,
  valueOf,
  writeShown,
  type Shown,
} from "./shown";

const job = (name: string, results: Record<string, number | null>): Job =>
  ({
    name,
    started_at: null,
    finished_at: null,
    summary: Object.fromEntries(Object.entries(results).map(([key, value]) => [key, { value, unit: "N" }])),
  }) as unknown as Job;
const jobs = [
  job("b", { max_force: 2, stretch: 9 }),
  job("A", { max_force: null, stretch: 7 }),
  job("c", { max_force: 1 }),
];
const names = (list: Job[]): string => list.map(({ name }) => name).join("");
const shown: Shown = { result: "", order: "", isFalling: false, pointer: "", columns: [] };

test("jobs stand as listed, by name whatever the case, or by the result shown", () => {
  expect(names(inOrder(jobs, shown))).toBe("bAc");
  expect(names(inOrder(jobs, { ...shown, order: "name" }))).toBe("Abc");
  expect(names(inOrder(jobs, { ...shown, order: "result" }))).toBe("cbA");
  expect(names(inOrder(jobs, { ...shown, order: "result", isFalling: true }))).toBe("bcA");
  expect(names(inOrder(jobs, { ...shown, result: "stretch", order: "result" }))).toBe("Abc");
});

test("the result shown is the one chosen, else the first", () => {
  expect(resultNames(jobs)).toEqual(["max_force", "stretch"]);
  expect(jobs.map((one) => resultOf(one, "stretch")?.quantity.value)).toEqual([9, 7, undefined]);
  expect(resultOf(jobs[0] as Job, "")?.name).toBe("max_force");
});

test("a column sorts, then the other way, then not at all; and the address says so", () => {
  const rising = pressed(shown, "name");
  const falling = pressed(rising, "name");
  expect([rising, falling].map(({ isFalling }) => isFalling)).toEqual([false, true]);
  expect(pressed(falling, "name")).toEqual(shown);
  const chosen = { ...falling, result: "stretch" };
  expect(readShown(new URLSearchParams(writeShown(chosen)))).toEqual(chosen);
  expect(readShown(new URLSearchParams("sort=-nonsense"))).toEqual(shown);
});

test("by a value the server sorts, and the address keeps it and the columns", () => {
  const rising = pressed({ ...shown, columns: ["/spec/seed", "/summary/stretch"] }, "value", "/spec/seed");
  expect(sortOf(rising)).toBe("/spec/seed");
  const falling = pressed(rising, "value", "/spec/seed");
  expect(sortOf(falling)).toBe("-/spec/seed");
  expect(readShown(new URLSearchParams(writeShown(falling)))).toEqual(falling);
  expect(inOrder(jobs, falling)).toBe(jobs);
  expect(sortOf(pressed(falling, "value", "/spec/other"))).toBe("/spec/other");
  expect(sortOf(pressed(falling, "value", "/spec/seed"))).toBe("");
  expect(readShown(new URLSearchParams("show=nonsense,/spec/a"))).toEqual({ ...shown, columns: ["/spec/a"] });
});

test("a value stands with its unit, a result as everywhere else", () => {
  const one = { ...jobs[0], values: { "/spec/bond/modulus_n": { value: 0.25, unit: "N" } } } as unknown as Job;
  expect(valueOf(one, "/spec/bond/modulus_n")).toEqual({ text: "0.25", unit: "N" });
  expect(valueOf(one, "/spec/none")).toBeNull();
  expect(valueOf(one, "/summary/max_force")?.unit).toBe("N");
  expect([labelOf("/spec/a~1b/0/c"), labelOf("/summary/max_force")]).toEqual(["a/b.0.c", "Max force"]);
});
