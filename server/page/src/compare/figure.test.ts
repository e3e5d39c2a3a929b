import { expect, test } from "vitest";
import { escaped, svgOf, ticksOf } from "./figure";
import { nearest, rangeOf, type Drawn } from "./manyPlot";

const line = (id: string, x: number[], y: number[]): Drawn => ({ id, name: id, x, y, colour: "--series-1" });

test("ticks are round and lie within", () => {
  expect(ticksOf([0, 1], 5)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
  expect(ticksOf([-0.013, 0.031], 4)).toEqual([0, 0.02]);
  expect(ticksOf([-3, 12], 6)).toEqual([0, 5, 10]);
});

test("a name is only ever a text", () => {
  const name = `"><script>alert(1)</script>&\u0000`;
  expect(escaped(name)).toBe("&quot;&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;");
  const range = rangeOf([line(name, [0, 1], [0, 1])]);
  const lines = [line(name, [0, 1], [0, 1])];
  const legend = [{ colour: "--series-1", text: name }];
  const svg = svgOf({ lines, range, axes: [name, name], legend, legendTitle: name, palette: () => "#123456" });
  expect(svg).not.toContain("<script");
  expect(svg).toContain('stroke="#123456"');
});

test("zero belongs to the range, and the highest point has room above it", () => {
  expect(rangeOf([line("a", [0, 10], [2, 20])])).toEqual({ x: [0, 10.1], y: [0, 21] });
  expect(rangeOf([])).toEqual({ x: [0, 1], y: [0, 1] });
});

test("the nearest point is found in pixels, and none far away", () => {
  const lines = [line("a", [0, 1, 2], [0, 0, 0]), line("b", [0, 1, 2], [1, 1, 1])];
  const at = (left: number, top: number): unknown => {
    const found = nearest(lines, { x: [0, 2], y: [0, 1] }, [200, 100], [left, top]);
    return found && [found.line.id, found.index];
  };
  expect(at(105, 8)).toEqual(["b", 1]);
  expect(at(105, 92)).toEqual(["a", 1]);
  expect(at(50, 50)).toBeNull();
});
