import { expect, test } from "vitest";
import { describeColumns, drawnOver, mainLine, usualHorizontal } from "./columns";
import { axisLabel } from "./names";

const TENSILE = ["nominal_strain", "force_n", "force_bottom_jaw_n", "broken_bonds"];
const SCENE = ["step", "time_s", "stage", "plate_displacement_m", "plate_force_n", "kinetic_energy_j"];
const BALLAST = ["time_s", "force_kn", "displacement_mm", "cycle", "unloading", "inertial_number", "broken_bonds"];
const SECTION = [
  "deflection_mm",
  "force_n",
  "load_fraction",
  "mean_top_deflection_mm",
  "mean_bottom_deflection_mm",
  "strain_energy_n_mm",
];

/** What is drawn over a column: the main line, and all that is shown. */
function drawn(
  columns: string[],
  horizontal = usualHorizontal(columns),
): { over?: string; main?: string; shown: string[] } {
  const names = drawnOver(horizontal, columns);
  expect(names.toSorted()).toEqual(columns.toSorted());
  const described = describeColumns(names);
  const shown = names.filter((_, index) => index > 0 && described[index]?.isShown);
  return { over: names[0], main: names[mainLine(described)], shown };
}

test("a tensile curve is about the force over strain", () => {
  expect(drawn(TENSILE)).toEqual({ over: "nominal_strain", main: "force_n", shown: TENSILE.slice(1) });
});

test("a scene is drawn over time, and about the force on the first plane", () => {
  expect(drawn(SCENE)).toEqual({ over: "time_s", main: "plate_force_n", shown: ["plate_force_n", "kinetic_energy_j"] });
});

test("a ballast test is drawn as force over displacement", () => {
  expect(drawn(BALLAST)).toEqual({ over: "displacement_mm", main: "force_kn", shown: ["force_kn", "broken_bonds"] });
  expect(drawn(BALLAST, "time_s").main).toBe("force_kn");
});

test("over the force, the first thing measured is the line", () => {
  expect(drawn(BALLAST, "force_kn")).toMatchObject({
    main: "displacement_mm",
    shown: ["displacement_mm", "broken_bonds"],
  });
});

test("a curve of unknown columns is about the second one", () => {
  expect(drawn(["depth", "salt", "heat"])).toEqual({ over: "depth", main: "salt", shown: ["salt"] });
});

test("a force is that on the moving jaw where there is a resting one", () => {
  const labels = (names: string[]): string[] => describeColumns(names).map(axisLabel);
  expect(labels(TENSILE)).toEqual([
    "Nominal strain [%]",
    "Force, moving jaw [N]",
    "Force, resting jaw [N]",
    "Broken bonds",
  ]);
  expect(labels(SECTION)).toEqual([
    "Deflection [mm]",
    "Force [N]",
    "Share of the load [%]",
    "Mean deflection, top face [mm]",
    "Mean deflection, bottom face [mm]",
    "Strain energy [N·mm]",
  ]);
});

test("a section is drawn as force over deflection, its motion over time", () => {
  expect(drawn(SECTION)).toEqual({ over: "deflection_mm", main: "force_n", shown: ["force_n"] });
  const motion = ["time_s", "mean_top_deflection_mm", "mean_bottom_deflection_mm", "kinetic_energy_n_mm"];
  expect(drawn(motion)).toMatchObject({ over: "time_s", main: "mean_top_deflection_mm" });
});
