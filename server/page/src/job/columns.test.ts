import { expect, test } from "vitest";
import { describeColumn, firstDrawn, mainLine } from "./columns";

function mainOf(names: string[]): string | undefined {
  const drawn = names.slice(firstDrawn(names));
  return drawn[mainLine(drawn.map(describeColumn))];
}

test("a tensile curve is about the force over strain", () => {
  const names = ["nominal_strain", "force_n", "force_bottom_jaw_n", "broken_bonds"];
  expect(firstDrawn(names)).toBe(0);
  expect(mainOf(names)).toBe("force_n");
});

test("a scene is drawn over time, and about the force on the first plane", () => {
  const names = ["step", "time_s", "stage", "plate_displacement_m", "plate_force_n", "kinetic_energy_j"];
  expect(names[firstDrawn(names)]).toBe("time_s");
  expect(mainOf(names)).toBe("plate_force_n");
  const shown = names.slice(1).filter((name, index) => index > 0 && describeColumn(name, index).isShown);
  expect(shown).toEqual(["plate_force_n", "kinetic_energy_j"]);
});
