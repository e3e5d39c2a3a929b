// What the columns of a curve are called and how they are drawn.
import { humanise } from "../format/words";

export interface Column {
  label: string;
  unit: string;
  /** Factor from the value in the file to the one shown. */
  factor: number;
  /** Whether it is drawn without being asked for. */
  isShown: boolean;
  /** Drawn thin, beside the main one. */
  isMinor: boolean;
}

const KNOWN: Record<string, Partial<Column>> = {
  nominal_strain: { label: "Nominal strain", unit: "%", factor: 100 },
  force_n: { label: "Force, moving jaw", unit: "N", isShown: true },
  force_bottom_jaw_n: { label: "Force, resting jaw", unit: "N", isShown: true, isMinor: true },
  broken_bonds: { label: "Broken bonds", unit: "", isShown: true, isMinor: true },
  residual_ratio: { label: "Residual over its limit", unit: "", isMinor: true },
  rounds: { label: "Rounds of breaking", unit: "", isMinor: true },
  stored_energy_n_mm: { isMinor: true },
  stage: { isShown: false, isMinor: true },
  kinetic_energy_j: { isShown: true, isMinor: true },
  width_strain: { label: "Width strain", unit: "%", factor: 100, isMinor: true },
};

// The unit is the end of a column's name; the longest ending wins.
const ENDINGS: [ending: string, unit: string][] = [
  ["_n_mm", "N·mm"], ["_n_per_m", "N/m"], ["_kpa", "kPa"], ["_mpa", "MPa"], ["_pa", "Pa"],
  ["_kn", "kN"], ["_mm", "mm"], ["_rad", "rad"], ["_n", "N"], ["_m", "m"], ["_s", "s"], ["_j", "J"],
];

export function describeColumn(name: string, index: number): Column {
  const ending = ENDINGS.find(([text]) => name.endsWith(text));
  const stem = ending ? name.slice(0, -ending[0].length) : name;
  return {
    label: humanise(stem),
    unit: ending?.[1] ?? "",
    factor: 1,
    // Of an unknown kind, the second column is what the first one is there for; forces always are.
    isShown: index === 1 || name.endsWith("_force_n"),
    isMinor: false,
    ...KNOWN[name],
  };
}

/** Number of the first column drawn: what is known over steps and over time is drawn over time. */
export function firstDrawn(names: string[]): number {
  return names[0] === "step" && names[1] === "time_s" ? 1 : 0;
}

/** Number of the line that the curve is about: the first one drawn strong. */
export function mainLine(columns: Column[]): number {
  return Math.max(1, columns.findIndex((column, index) => index > 0 && column.isShown && !column.isMinor));
}

/** Label and unit, as on an axis. */
export function axisLabel({ label, unit }: Column): string {
  return unit ? `${label} [${unit}]` : label;
}

/** Index of the largest value; -1 when there is none. */
export function indexOfMaximum(values: number[]): number {
  let best = -1;
  values.forEach((value, index) => {
    if (Number.isFinite(value) && (best < 0 || value > (values[best] ?? -Infinity))) best = index;
  });
  return best;
}
