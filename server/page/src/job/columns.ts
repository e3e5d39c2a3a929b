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
  force_kn: { label: "Force", unit: "kN", isShown: true },
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

function describe(name: string): Column {
  const ending = ENDINGS.find(([text]) => name.endsWith(text));
  const stem = ending ? name.slice(0, -ending[0].length) : name;
  return {
    label: humanise(stem),
    unit: ending?.[1] ?? "",
    factor: 1,
    isShown: name.endsWith("_force_n"),
    isMinor: false,
    ...KNOWN[name],
  };
}

/** Columns in the order drawn, the horizontal one first; at least one line is shown strong. */
export function describeColumns(names: string[]): Column[] {
  const columns = names.map(describe);
  const second = columns[1];
  if (second && !columns.some(isStrong)) Object.assign(second, { isShown: true, isMinor: false });
  return columns;
}

/** A column's name for people, with its unit. */
export function columnTitle(name: string): string {
  return axisLabel(describe(name));
}

/** What tells when a row was measured; as lines these come last. */
const CLOCKS = ["step", "time_s", "stage", "cycle", "unloading"];

/** The column a curve is drawn over unless somebody chooses another. */
export function usualHorizontal(names: string[]): string {
  // A load that comes back is read as a loop, force over displacement.
  if (names.includes("unloading") && names.includes("displacement_mm")) return "displacement_mm";
  // What is known over steps and over time is drawn over time.
  return (names[0] === "step" && names[1] === "time_s" ? names[1] : names[0]) ?? "";
}

/** Columns of a curve in the order drawn: the horizontal one, what was measured, then the clocks. */
export function drawnOver(horizontal: string, names: string[]): string[] {
  const others = names.filter((name) => name !== horizontal);
  const isClock = (name: string): boolean => CLOCKS.includes(name);
  return [horizontal, ...others.filter((name) => !isClock(name)), ...others.filter(isClock)];
}

/** Number of the line that the curve is about: the first one drawn strong. */
export function mainLine(columns: Column[]): number {
  return Math.max(1, columns.findIndex(isStrong));
}

function isStrong({ isShown, isMinor }: Column, index: number): boolean {
  return index > 0 && isShown && !isMinor;
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
