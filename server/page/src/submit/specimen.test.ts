import { expect, test, vi } from "vitest";
import { scalarsOf, tellingScalars } from "../snapshots/frames";

/** What was asked for, and how the server answers. */
const server = { asked: [] as string[], answer: (): Promise<object> => Promise.resolve({}) };

vi.mock("../api/client", () => ({
  complaintsOf: (error: Error) => [error.message],
  request: async (_path: string, { body }: { body: string }) => {
    server.asked.push(body);
    const answer = await server.answer();
    return { json: () => Promise.resolve(answer) };
  },
}));

const { bytesOf, Specimen, subjectOfBody } = await import("./specimen.svelte");

const FABRIC = JSON.stringify({ kind: "nonwoven_tensile", spec: {} });

test("a body says what its specimen is of", () => {
  expect(subjectOfBody(FABRIC)).toBe("fabric");
  expect(subjectOfBody(JSON.stringify({ kind: "ballast_box", spec: {} }))).toBe("scene");
  const fibre = { kind: "paper_tensile", spec: { specimen: { single_fibre: {} } } };
  expect(subjectOfBody(JSON.stringify(fibre))).toBe("fibre");
  // a calibration's is that of the job whose parameters are sought
  expect(subjectOfBody(JSON.stringify({ kind: "calibrate", spec: { job: fibre } }))).toBe("fibre");
});

test("base64 is bytes", () => {
  expect([...new Uint8Array(bytesOf("AP9/"))]).toEqual([0, 255, 127]);
});

test("a spec is drawn once, and the answer to an earlier one is not taken for a later one", async () => {
  const specimen = new Specimen();
  const releases: ((shows: string) => void)[] = [];
  server.asked = [];
  server.answer = () => new Promise((resolve) => releases.push((shows) => resolve({ shows, files: [] })));
  const first = specimen.ask(FABRIC, "one");
  await specimen.ask(FABRIC, "one");
  expect(server.asked.length).toBe(1);
  const second = specimen.ask(FABRIC, "two");
  releases[1]?.("the second");
  await second;
  releases[0]?.("the first");
  await first;
  expect(specimen.preview?.shows).toBe("the second");
  expect(specimen.isBusy).toBe(false);
});

test("what cannot be drawn is told, and the picture of before is gone", async () => {
  const specimen = new Specimen();
  server.answer = () => Promise.resolve({ shows: "a fabric", files: [] });
  await specimen.ask(FABRIC, "one");
  server.answer = () => Promise.reject(new Error("too large"));
  await specimen.ask(FABRIC, "two");
  expect([specimen.preview, specimen.errors]).toEqual([null, ["too large"]]);
  server.answer = () => Promise.resolve({ shows: "a fabric", files: [] });
  await specimen.ask(FABRIC, "three");
  expect(specimen.errors).toEqual([]);
});

test("what is the same everywhere tells nothing", () => {
  const all = scalarsOf([
    { name: "force_n", components: 1, values: Float64Array.of(0, 0, 0) },
    { name: "body", components: 1, values: Int32Array.of(0, 1, 1) },
  ]);
  expect(tellingScalars(all).map(({ name }) => name)).toEqual(["body"]);
});
