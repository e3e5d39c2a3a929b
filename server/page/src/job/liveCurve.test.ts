import { beforeEach, describe, expect, it, vi } from "vitest";
import type { Curve } from "../api/types";

const server = { attempt: 1, total: 0, asked: [] as number[] };

vi.mock("../api/client", () => ({
  Refusal: class extends Error {},
  getJson: async (path: string): Promise<Curve> => {
    const since = Number(new URLSearchParams(path.split("?")[1]).get("since"));
    server.asked.push(since);
    const { attempt, total } = server;
    await Promise.resolve();
    const points = Array.from({ length: Math.max(0, total - since) }, (_, index) => [since + index, attempt]);
    return { columns: ["nominal_strain", "force_n"], attempt, points, next: total, complete: false };
  },
}));

const { LiveCurve } = await import("./liveCurve.svelte");

const range = (count: number): number[] => Array.from({ length: count }, (_, index) => index);

describe("LiveCurve", () => {
  beforeEach(() => Object.assign(server, { attempt: 1, total: 0, asked: [] }));

  it("fetches only what is new", async () => {
    const curve = new LiveCurve("/curve");
    server.total = 3;
    await curve.fetch();
    server.total = 5;
    await curve.fetch();
    expect(server.asked).toEqual([0, 3]);
    expect(curve.values[0]).toEqual(range(5));
  });

  it("begins again when another attempt computes the curve", async () => {
    const curve = new LiveCurve("/curve");
    server.total = 4;
    await curve.fetch();
    Object.assign(server, { attempt: 2, total: 6 });
    await curve.fetch();
    expect(curve.values).toEqual([range(6), Array(6).fill(2)]);
  });

  it("never holds a point twice when calls overlap", async () => {
    const curve = new LiveCurve("/curve");
    server.total = 2;
    const first = curve.fetch();
    server.total = 4;
    await Promise.all([first, curve.fetch(), curve.fetch()]);
    expect(curve.values[0]).toEqual(range(4));
  });

  it("thins a long curve out by asking for all of it again", async () => {
    const curve = new LiveCurve("/curve");
    server.total = 7000;
    await curve.fetch();
    await curve.fetch();
    expect(server.asked).toEqual([0, 0]);
  });
});
