import { expect, test, vi } from "vitest";
import type { Job } from "../api/types";

/** What the server answers about the job, and when. */
const server = { answer: Promise.resolve({}) };

vi.mock("../api/client", () => ({
  Refusal: class extends Error {},
  Unreachable: class extends Error {},
  messageOf: String,
  getJson: async (path: string): Promise<object> =>
    path.endsWith("/a") ? server.answer : { items: [], columns: [], points: [], next: 0, attempt: 1, complete: true },
}));

const { LiveJob } = await import("./liveJob.svelte");

const job = (changes: object): Job => {
  const some: object = {
    id: "a",
    kind: "ballast_box",
    status: "running",
    outcome: null,
    attempt: 1,
    updated_at: "2026-01-01T00:00:00Z",
    ...changes,
  };
  return some as Job;
};
const END = { status: "finished", outcome: "failed", updated_at: "2026-01-01T00:00:01Z" };

test("the end of a job is not lost when it overtakes the first answer", async () => {
  let release: (job: object) => void = () => {};
  server.answer = new Promise((resolve) => (release = resolve));
  const live = new LiveJob("a");
  const fetched = live.refresh();
  live.event({ event: "job", data: job(END) });
  release(job({ spec: { seed: 7 } }));
  await fetched;
  expect(live.job).toMatchObject({ ...END, spec: { seed: 7 } });
});

test("an event that is older than what is known changes nothing", async () => {
  server.answer = Promise.resolve(job({ ...END, spec: { seed: 7 } }));
  const live = new LiveJob("a");
  await live.refresh();
  live.event({ event: "job", data: job({}) });
  expect(live.job).toMatchObject({ ...END, spec: { seed: 7 } });
  live.stop();
});
