import { expect, test } from "vitest";
import { parseCsv } from "./csv";
import { drawingOf, restingRow } from "./drawing";
import { TABLES, type FileTable } from "./tables";

function known(file: string): FileTable {
  const found = TABLES.find((description) => description.file === file);
  if (!found) throw new Error(`${file} is not described`);
  return found;
}

const PATH =
  "stress_kpa,log10_stress_over_kpa,axial_strain,void_ratio\n-1,0,0,0.96\n10,1,0.01,0.94\n100,2,0.1,0.7\n10,1,0.08,0.75\n";

test("void ratio over the logarithm of stress leaves out tension", () => {
  const drawing = drawingOf(known("oedometer.csv"), parseCsv(PATH));
  expect(drawing?.values[0]).toEqual([NaN, 10, 100, 10]);
  expect(drawing?.values[1]).toEqual([0.96, 0.94, 0.7, 0.75]);
  // strain in %, when asked for
  expect(drawing?.values[2]).toEqual([0, 1, 10, 8]);
  expect(drawing?.columns.map(({ isShown }) => isShown).slice(1)).toEqual([true, false]);
});

test("the curve beside it tells cycles and unloading, if it has the same rows", () => {
  const curve = parseCsv("cycle,unloading\n1,0\n1,0\n1,0\n1,1\n");
  expect(drawingOf(known("oedometer.csv"), parseCsv(PATH), curve)).toMatchObject({
    cycles: [1, 1, 1, 1],
    unloading: [0, 0, 0, 1],
  });
  const longer = parseCsv("cycle,unloading\n1,0\n1,0\n1,0\n1,1\n1,1\n");
  expect(drawingOf(known("oedometer.csv"), parseCsv(PATH), longer)).toMatchObject({
    cycles: undefined,
    unloading: undefined,
  });
});

test("a step of stress has one modulus from its one end to the other", () => {
  const steps = parseCsv("unloading,from_stress_kpa,to_stress_kpa,oedometric_modulus_mpa\n0,50,100,4\n1,100,50,12\n");
  const drawing = drawingOf(known("oedometric_modulus.csv"), steps);
  expect(drawing?.values).toEqual([
    [50, 100, 100, 50],
    [4, 4, 12, 12],
  ]);
  expect(drawing?.unloading).toEqual([0, 0, 1, 1]);
  expect(drawing?.columns[0]).toMatchObject({ label: "Stress", unit: "kPa" });
});

test("slices of the bed stand above each other, each with three porosities", () => {
  const slices = parseCsv(
    "lower_m,upper_m,porosity_before_loading,porosity_at_peak,porosity_at_end\n0,0.03,0.45,0.42,\n0.03,0.06,0.42,0.36,0.41\n",
  );
  const drawing = drawingOf(known("porosity_profile.csv"), slices);
  expect(drawing?.values[0]).toEqual([0, 0.03, 0.03, 0.06]);
  expect(drawing?.values[3]).toEqual([NaN, NaN, 0.41, 0.41]);
  expect(drawing?.columns[0]).toMatchObject({ label: "Height", unit: "m" });
});

test("settlement is drawn over its cycles, which are no branches then", () => {
  const cycles = parseCsv("cycle,end_displacement_mm,settlement_in_cycle_mm\n1,26.5,26.5\n2,29.85,3.35\n");
  expect(drawingOf(known("cycles.csv"), cycles)).toMatchObject({
    values: [
      [1, 2],
      [26.5, 29.85],
      [26.5, 3.35],
    ],
    cycles: undefined,
  });
});

test("fragments of each moment are a curve that rises with their size to all of the mass", () => {
  const { rearrange } = known("fragment_moments.csv");
  const curves = rearrange?.(
    parseCsv(
      "moment,largest_fragment_members,mass_share_1,mass_share_2_to_9,mass_share_10_to_49,mass_share_50_to_134,mass_share_from_135\n" +
        "poured,140,0,0,0,0,1\nend,140,0.25,0.25,0,0.25,0.25\n",
    ),
  );
  expect(curves).toEqual({
    columns: ["fragment_members", "finer_poured", "finer_end"],
    rows: [
      ["1", "0", "0.25"],
      ["9", "0", "0.5"],
      ["49", "0", "0.5"],
      ["134", "0", "0.75"],
      ["140", "1", "1"],
    ],
  });
  const small = rearrange?.(
    parseCsv("moment,largest_fragment_members,mass_share_1,mass_share_2_to_9,mass_share_10_to_49\npeak,8,0.5,0.5,0\n"),
  );
  expect(small?.rows).toEqual([
    ["1", "0.5"],
    ["8", "1"],
  ]);
});

test("results converge over the cells, whichever test it was", () => {
  const held = drawingOf(
    known("convergence.csv"),
    parseCsv(
      "cells_x,cells_y,mean_top_deflection_mm,deflection_ratio,natural_frequency_hz\n25,20,0.5,2,90\n50,40,0.6,2,95\n",
    ),
  );
  expect(held?.columns.map(({ label, unit, isShown }) => [label, unit, isShown])).toEqual([
    ["Cells along x", "", false],
    ["Mean deflection, top face", "mm", true],
    ["Deflection ratio", "", false],
    ["Natural frequency", "Hz", false],
  ]);
  const bent = drawingOf(
    known("convergence.csv"),
    parseCsv("cells_x,flexural_modulus_mpa,flexural_strain\n25,9e3,0.01\n"),
  );
  expect(bent?.columns[1]).toMatchObject({ label: "Flexural modulus", unit: "MPa", isShown: true });
  expect(bent?.values[2]).toEqual([1]);
});

test("a face is drawn by its displacement across, along when asked for", () => {
  const face = drawingOf(known("faces/top.csv"), parseCsv("along_mm,ux_mm,uy_mm\n0,0,0\n0.7,0.01,-0.02\n1.4,0,0\n"));
  expect(face?.values).toEqual([
    [0, 0.7, 1.4],
    [0, -0.02, 0],
    [0, 0.01, 0],
  ]);
  // held at both ends, it tells most between them
  expect(face && restingRow(known("faces/top.csv"), face)).toBe(1);
  expect(face?.columns.map(({ label, isShown }) => [label, isShown])).toEqual([
    ["Place along the face", false],
    ["Displacement, along y", true],
    ["Displacement, along x", false],
  ]);
});

test("what a file lacks is not drawn, and a file of words is a table only", () => {
  expect(drawingOf(known("cycles.csv"), parseCsv("cycle,salt\n1,2\n"))).toBeNull();
  expect(drawingOf(known("oedometer.csv"), parseCsv("void_ratio\n0.7\n"))).toBeNull();
  expect(drawingOf(known("preparation.csv"), parseCsv("stage,phase\n1,pour\n"))).toBeNull();
});

test("the mass curve over the size of fragments is told in per cent", () => {
  const sizes = parseCsv("members,fragments,mass_kg,mass_share_up_to\n1,40,0.4,0.25\n13,9,1.2,1\n");
  const drawing = drawingOf(known("fragment_sizes.csv"), sizes);
  expect(drawing?.values.slice(0, 2)).toEqual([
    [1, 13],
    [25, 100],
  ]);
  expect(drawing?.columns[1]).toMatchObject({ label: "Finer by mass", unit: "%" });
  expect(drawing?.columns[2]).toMatchObject({ unit: "kg" });
});
