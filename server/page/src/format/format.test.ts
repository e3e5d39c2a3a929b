import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { formatJson } from "./json";
import { formatBytes, formatChosen, formatError, formatNumber } from "./numbers";
import { formatAgo, formatDuration, formatEta } from "./time";
import { inWords, sentence, showQuantity, showUnit } from "./words";

const plain = (text: string): string => text.replaceAll("\u202f", " ");

describe("numbers", () => {
  it.each([
    [403.27, "403.3"],
    [0.5622, "0.5622"],
    [90.48, "90.48"],
    [-12.3456, "−12.35"],
    [26683, "26 683"],
    [1234.5, "1235"],
    [123456.7, "123 457"],
    [2.1e8, "2.1 × 10⁸"],
    [3.14159e-6, "3.142 × 10⁻⁶"],
    [0, "0"],
    [Number.NaN, "–"],
  ])("%f reads %s", (value, text) => expect(plain(formatNumber(value))).toBe(text));

  it.each([
    [0, "0 B"],
    [999, "999 B"],
    [1000, "1.0 kB"],
    [48_200, "48 kB"],
    [999_600, "1.0 MB"],
    [2_400_000_000, "2.4 GB"],
  ])("%d bytes read %s", (bytes, text) => expect(plain(formatBytes(bytes))).toBe(text));
});

describe("times", () => {
  it.each([
    [0.85, "850 ms"],
    [9.94, "9.9 s"],
    [3, "3 s"],
    [59.4, "59 s"],
    [200, "3 min 20 s"],
    [3600, "1 h"],
    [7530, "2 h 6 min"],
    [90_000, "1 d 1 h"],
  ])("%f s reads %s", (seconds, text) => expect(plain(formatDuration(seconds))).toBe(text));

  it("rounds an estimate", () => {
    expect(plain(formatEta(0.4))).toBe("almost done");
    expect(plain(formatEta(41.2))).toBe("about 42 s left");
    expect(plain(formatEta(400))).toBe("about 7 min left");
  });

  it("counts back from now, and never into the future", () => {
    const now = Date.parse("2026-11-21T12:00:00Z");
    expect(formatAgo(now + 5000, now)).toBe("just now");
    expect(plain(formatAgo(now - 190_000, now))).toBe("3 min ago");
    expect(formatAgo(now - 30 * 86_400_000, now)).toBe("2026-10-22");
  });
});

describe("quantities", () => {
  it("shows strains in % and keeps the exact value", () => {
    const shown = showQuantity("strain_at_max_force", { value: 1.13, unit: "1" });
    expect([shown.text, shown.unit, shown.exact]).toEqual(["113.0", "%", "1.13 (dimensionless)"]);
  });

  it("shows the scatter of repeats in the unit of the value", () => {
    const shown = showQuantity("strain_at_max_force", { value: 1.13, unit: "1", deviation: 0.0213, n: 5 });
    expect([shown.scatter, shown.error]).toEqual(["deviation 2.1 of 5", undefined]);
    const ratio = showQuantity("anisotropy_of_strain_at_max_force", { value: 1.5, unit: "1" });
    expect([ratio.text, ratio.unit, ratio.scatter]).toEqual(["1.500", "", undefined]);
  });

  it("shows the interval of a fitted value", () => {
    const shown = showQuantity("bond_modulus_n", { value: 0.4, unit: "N", interval: [0.38, 0.42] });
    expect(plain(shown.scatter ?? "")).toBe("0.3800 … 0.4200");
  });

  it("shows how wrong a value may be, of a mean beside the deviation of what it is made of", () => {
    const error = { value: 8.136e-5, parts: [{ source: "grid", value: 8.136e-5, basis: "two_grids" as const }] };
    const shown = showQuantity("mean_top_deflection", { value: 0.052366, unit: "mm", error });
    expect([shown.error, shown.scatter, shown.exact]).toEqual([
      "± 0.000081",
      undefined,
      "0.052366 mm, standard error 0.00008136",
    ]);
    const both = showQuantity("deflection", { value: 0.05, unit: "mm", deviation: 0.003, n: 5, error });
    expect([both.error, both.scatter, both.exact]).toEqual([
      "± 0.000081",
      "deviation 0.003 of 5",
      "0.05 mm, mean of 5, standard deviation 0.003, standard error 0.00008136",
    ]);
    const modulus = showQuantity("modulus", { value: 7e7, unit: "Pa", error: { value: 1.234e6, parts: [] } });
    expect([modulus.text, modulus.error]).toEqual(["70", "± 1.2"]);
    const given = showQuantity("max_force", { value: 10, unit: "N", error: { value: 0, parts: [] } });
    const even = showQuantity("modulus", { value: 655.7, unit: "MPa", error: { value: 2e-12, parts: [] } });
    expect([given.error, even.error]).toEqual([undefined, undefined]);
  });

  it("leaves other pure numbers alone and says when a value is unknown", () => {
    expect(showQuantity("poisson_ratio", { value: 0.56, unit: "1" }).unit).toBe("");
    expect(showQuantity("max_force", { value: null, unit: "N" }).text).toBe("–");
  });

  it("turns names into words as the program does", () => {
    const list = new URL("../../../../tests/data/words.json", import.meta.url);
    const cases = JSON.parse(readFileSync(list, "utf8")) as [string, string][];
    for (const [name, words] of cases) expect(inWords(name)).toBe(words);
  });

  it("speaks of MPa and kPa", () => {
    const shown = showQuantity("modulus_at_10_percent_pa", { value: 68_860_000, unit: "Pa" });
    expect([shown.text, shown.unit, shown.exact]).toEqual(["68.86", "MPa", "68860000 Pa"]);
    expect(showQuantity("strength_pa", { value: 2500, unit: "Pa" }).unit).toBe("kPa");
  });

  it("writes products and powers", () => {
    expect([showUnit("N m/g"), showUnit("J/m2"), showUnit("N"), showUnit("1")]).toEqual(["N·m/g", "J/m²", "N", ""]);
  });
});

describe("chosen numbers", () => {
  it.each([
    [0.01, "0.01"],
    [1000, "1000"],
    [12.5, "12.5"],
    [1e-6, "1 × 10⁻⁶"],
  ])("%f reads %s", (value, text) => expect(plain(formatChosen(value))).toBe(text));
});

describe("errors", () => {
  it.each([
    [0.0213, "0.021"],
    [1.96, "2"],
    [4213, "4200"],
    [8.136e-5, "0.000081"],
    [2.97e-5, "0.00003"],
    [9.96e-5, "0.0001"],
    [4.07e-7, "4.1 × 10⁻⁷"],
    [0, "0"],
  ])("%f reads %s", (value, text) => expect(plain(formatError(value))).toBe(text));
});

describe("reasons", () => {
  it("are written as sentences", () => {
    expect(["no load path", "It ended.", ""].map(sentence)).toEqual(["No load path.", "It ended.", ""]);
  });
});

describe("JSON", () => {
  it("keeps short lists on a line, and every value", () => {
    const value = {
      a: [1, 2.5, 3],
      b: { c: null, d: [] },
      e: [{ nodes: [0, 1] }, { nodes: [1, 2] }],
      f: "x".repeat(90),
    };
    const text = formatJson(value);
    expect(JSON.parse(text)).toEqual(value);
    expect(text).toContain('"a": [1, 2.5, 3],');
    expect(text).toContain('\n  "b": {\n');
  });
});
