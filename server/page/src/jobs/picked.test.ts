import { expect, test } from "vitest";
import type { Job } from "../api/types";
import { Picked } from "./picked.svelte";

const jobs = ["a", "b", "c", "d"].map((id) => ({ id }) as Job);
const ids = (picked: Picked): string[] => picked.jobs.map(({ id }) => id).toSorted();
const [a, b, c, d] = jobs as [Job, Job, Job, Job];

test("jobs are picked one by one and let go again", () => {
  const picked = new Picked();
  picked.toggle(a, jobs, false);
  picked.toggle(c, jobs, false);
  expect(ids(picked)).toEqual(["a", "c"]);
  picked.toggle(a, jobs, false);
  expect(ids(picked)).toEqual(["c"]);
});

test("with the shift key all between are picked, whichever way", () => {
  const picked = new Picked();
  picked.toggle(d, jobs, false);
  picked.toggle(b, jobs, true);
  expect(ids(picked)).toEqual(["b", "c", "d"]);
  // A job that is no longer shown begins no range.
  picked.clear();
  picked.toggle(a, [b, c, d], true);
  expect(ids(picked)).toEqual(["a"]);
});

test("all that are shown are picked beside those of another page", () => {
  const picked = new Picked();
  picked.toggle(a, jobs, false);
  picked.setAll([c, d], true);
  expect(ids(picked)).toEqual(["a", "c", "d"]);
  picked.setAll([c, d], false);
  expect(ids(picked)).toEqual(["a"]);
});
