// What the columns of curves and tables are called, and in which units.
import { humanise } from "../format/words";

export interface Column {
  /** As the file has it. */
  name: string;
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
  force_n: { isShown: true },
  force_bottom_jaw_n: { label: "Force, resting jaw", unit: "N", isShown: true, isMinor: true },
  broken_bonds: { label: "Broken bonds", unit: "", isShown: true, isMinor: true },
  residual_ratio: { label: "Residual over its limit", unit: "", isMinor: true },
  rounds: { label: "Rounds of breaking", unit: "", isMinor: true },
  stored_energy_n_mm: { isMinor: true },
  dissipated_n_mm: { label: "Energy taken by cracks" },
  crack_area_mm2: { label: "Crack area of the event", isMinor: true },
  events: { label: "Events", isMinor: true },
  stage: { isShown: false, isMinor: true },
  kinetic_energy_j: { isShown: true, isMinor: true },
  width_strain: { label: "Width strain", unit: "%", factor: 100, isMinor: true },
  tangent_poisson_ratio: { label: "Poisson ratio, tangent" },
  axial_strain: { label: "Axial strain", unit: "%", factor: 100 },
  log10_stress_over_kpa: { label: "log₁₀ (stress / kPa)", unit: "" },
  start_displacement_mm: { label: "Displacement, at the start" },
  peak_displacement_mm: { label: "Displacement, deepest" },
  end_displacement_mm: { label: "Displacement, at the end" },
  settlement_in_cycle_mm: { label: "Settlement in the cycle" },
  unloading_stiffness_n_per_m: { label: "Stiffness, unloading" },
  loading_stiffness_n_per_m: { label: "Stiffness, loading" },
  load_fraction: { label: "Share of the load", unit: "%", factor: 100 },
  mean_top_deflection_mm: { label: "Mean deflection, top face" },
  mean_bottom_deflection_mm: { label: "Mean deflection, bottom face" },
  flexural_strain: { label: "Flexural strain", unit: "%", factor: 100 },
  cells_x: { label: "Cells along x" },
  cells_y: { label: "Cells along y" },
  along_mm: { label: "Place along the face" },
  x_mm: { label: "x" },
  y_mm: { label: "y" },
  ux_mm: { label: "Displacement, along x" },
  uy_mm: { label: "Displacement, along y" },
  fibre_share: { label: "Share of fibre" },
  strain_xy: { label: "Shear strain xy" },
  stress_xy_mpa: { label: "Shear stress xy" },
  stress_mises_mpa: { label: "Stress, von Mises" },
  from_stress_kpa: { label: "Stress, from" },
  to_stress_kpa: { label: "Stress, to" },
  from_void_ratio: { label: "Void ratio, from" },
  to_void_ratio: { label: "Void ratio, to" },
  lower_m: { label: "Height, from" },
  upper_m: { label: "Height, to" },
  porosity_before_loading: { label: "Porosity, before loading" },
  porosity_at_peak: { label: "Porosity, at the peak" },
  porosity_at_end: { label: "Porosity, at the end" },
  fragment_members: { label: "Spheres in a fragment, at most" },
  members: { label: "Spheres in a fragment" },
  mass_share_up_to: { label: "Finer by mass", unit: "%", factor: 100 },
  finer_poured: { label: "Finer by mass, when poured", unit: "%", factor: 100 },
  finer_before_loading: { label: "Finer by mass, before loading", unit: "%", factor: 100 },
  finer_peak: { label: "Finer by mass, at the peak", unit: "%", factor: 100 },
  finer_end: { label: "Finer by mass, at the end", unit: "%", factor: 100 },
  bin_lower_n: { label: "Force on a bond, from" },
  bin_upper_n: { label: "Force on a bond, to" },
  nominal_strain_from: { label: "Nominal strain, from", unit: "%", factor: 100 },
  nominal_strain_to: { label: "Nominal strain, to", unit: "%", factor: 100 },
};
/** Share of the mass in fragments of so many spheres: `mass_share_1`, `_2_to_9`, `_from_135`. */
export const MASS_SHARE = /^mass_share_(from_)?(\d+)(?:_to_(\d+))?$/;

// The unit is the end of a column's name; the longest ending wins.
const ENDINGS: [ending: string, unit: string][] = [
  ["_rad_per_s", "rad/s"],
  ["_m_per_s", "m/s"],
  ["_n_per_mm", "N/mm"],
  ["_n_mm", "N·mm"],
  ["_n_per_m", "N/m"],
  ["_mm2", "mm²"],
  ["_um", "µm"],
  ["_kpa", "kPa"],
  ["_mpa", "MPa"],
  ["_pa", "Pa"],
  ["_kn", "kN"],
  ["_kg", "kg"],
  ["_mm", "mm"],
  ["_rad", "rad"],
  ["_n", "N"],
  ["_m", "m"],
  ["_hz", "Hz"],
  ["_s", "s"],
  ["_j", "J"],
];

export function describe(name: string): Column {
  const ending = ENDINGS.find(([text]) => name.endsWith(text));
  const stem = ending ? name.slice(0, -ending[0].length) : name;
  return {
    name,
    label: humanise(stem),
    unit: ending?.[1] ?? "",
    factor: 1,
    isShown: name.endsWith("_force_n"),
    isMinor: false,
    ...massShare(name),
    ...KNOWN[name],
  };
}

/** Names that mean more beside others: with the force on the one jaw, the force is that on the other. */
const BESIDE: [name: string, other: string, label: string][] = [["force_n", "force_bottom_jaw_n", "Force, moving jaw"]];

/** All columns of one table. */
export function describeAll(names: string[]): Column[] {
  return names.map((name) => {
    const [, , label] = BESIDE.find(([own, other]) => own === name && names.includes(other)) ?? [];
    return { ...describe(name), ...(label && { label }) };
  });
}

function massShare(name: string): Partial<Column> | undefined {
  const match = MASS_SHARE.exec(name);
  if (!match) return undefined;
  const [, from, first = "", last] = match;
  const range = from ? `from ${first}` : last ? `${first}–${last}` : first;
  return { label: `Share of mass, ${range} ${range === "1" ? "sphere" : "spheres"}`, unit: "%", factor: 100 };
}

/** Label and unit, as on an axis. */
export function axisLabel({ label, unit }: Column): string {
  return unit ? `${label} [${unit}]` : label;
}

/** What stands before the comma: `Porosity, at the end` is a porosity. */
export function stemOf(label: string): string {
  return label.split(",")[0] ?? label;
}
