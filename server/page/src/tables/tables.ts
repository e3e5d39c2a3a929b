// The files of tests that are shown as plots or tables. A file's name means the same whatever the
// kind of job that writes it, so the list is by file; what a job has not written is not shown.
import type { PlotStyle } from "../plot/style";
import type { Table } from "./csv";
import { massCurves } from "./fragments";

export interface FileTable {
  file: string;
  title: string;
  /** What it shows, for somebody who sees it for the first time. */
  about: string;
  /** The column drawn over; of two, each row holds from the one to the other. Without it the file is shown as a table. */
  over?: string | [from: string, to: string];
  /** Columns drawn, and those drawn when asked for. */
  lines?: string[];
  more?: string[] | { allBut: string[] };
  style?: PlotStyle;
  /** The row that tells most when nobody points at one: else the last. */
  restsAt?: "first" | "largest";
  /** Fewer rows tell nothing. */
  leastRows?: number;
  /** Makes of the file what is drawn. */
  rearrange?: (table: Table) => Table;
  /** A file whose rows are of the same moments; it knows which are of which cycle, loading or unloading. */
  beside?: string;
}

export const TABLES: FileTable[] = [
  {
    file: "cycles.csv",
    title: "Settlement by cycle",
    about: "Displacement that is left when a cycle ends, and what the cycle itself added.",
    over: "cycle",
    lines: ["end_displacement_mm", "settlement_in_cycle_mm"],
    more: ["peak_displacement_mm", "unloading_stiffness_n_per_m", "loading_stiffness_n_per_m", "dissipated_energy_j"],
    style: { hasPoints: true },
    leastRows: 2,
  },
  {
    file: "blocks.csv",
    title: "Settlement by block",
    about: "Displacement that is left when the cycles of a load end, and what they added.",
    over: "block",
    lines: ["end_displacement_mm", "settlement_in_block_mm"],
    more: ["peak_displacement_mm", "first_unloading_stiffness_n_per_m", "last_unloading_stiffness_n_per_m"],
    style: { hasPoints: true },
    leastRows: 2,
  },
  {
    file: "oedometer.csv",
    title: "Void ratio over stress",
    about: "Stress by powers of ten, as oedometer tests are read.",
    over: "stress_kpa",
    lines: ["void_ratio"],
    more: ["axial_strain"],
    style: { isLogarithmic: true, floats: true },
    beside: "curve.csv",
  },
  {
    file: "oedometric_modulus.csv",
    title: "Oedometric modulus by step",
    about:
      "Change of stress over change of strain in each step of the first cycle; a step doubles or halves the stress.",
    over: ["from_stress_kpa", "to_stress_kpa"],
    lines: ["oedometric_modulus_mpa"],
    style: { isLogarithmic: true },
  },
  {
    file: "porosity_profile.csv",
    title: "Porosity over height",
    about: "In slices of the bed below plate or sleeper, from the ground up.",
    over: ["lower_m", "upper_m"],
    lines: ["porosity_before_loading", "porosity_at_peak", "porosity_at_end"],
    style: { isUpright: true, floats: true },
  },
  {
    file: "fragment_moments.csv",
    title: "Mass by size of fragment",
    about: "Share of the mass in fragments of at most so many spheres, as a sieve curve.",
    over: "fragment_members",
    lines: ["finer_poured", "finer_before_loading", "finer_peak", "finer_end"],
    style: { isLogarithmic: true, hasPoints: true },
    restsAt: "first",
    rearrange: massCurves,
  },
  {
    file: "fragment_sizes.csv",
    title: "Mass by size of fragment, at the end",
    about: "Share of the mass in fragments of at most so many spheres, size by size.",
    over: "members",
    lines: ["mass_share_up_to"],
    more: ["mass_kg", "fragments"],
    style: { isLogarithmic: true, hasPoints: true },
    restsAt: "first",
  },
  {
    file: "fragments.csv",
    title: "Fragments over time",
    about: "Shares of the mass by the number of spheres in a fragment.",
    over: "time_s",
    lines: ["mass_share_1", "mass_share_2_to_9", "mass_share_10_to_49", "mass_share_50_to_134", "mass_share_from_135"],
    more: ["fragments", "whole_grains"],
  },
  {
    file: "preparation.csv",
    title: "Preparation",
    about: "The bed at the end of every stage.",
  },
  {
    file: "fit.csv",
    title: "Measured and fitted",
    about: "Each measured result, what the best parameters give, and how specimens scatter about it.",
  },
  {
    file: "fit_curve.csv",
    title: "Measured and fitted curve",
    about: "What was measured, and the mean of the specimens with the best parameters.",
    over: "abscissa",
    lines: ["measured", "fitted"],
  },
  {
    file: "trials.csv",
    title: "Misfit by trial",
    about: "Root mean square of the residuals of every trial; the last ones are steps around the best.",
    over: "trial",
    lines: ["misfit"],
    style: { hasPoints: true },
  },
  {
    file: "poisson_ratio.csv",
    title: "Poisson ratio",
    about: "Lateral contraction over nominal strain, from the start; tangent: from one step to the next.",
    over: "nominal_strain",
    lines: ["poisson_ratio"],
    more: ["tangent_poisson_ratio", "width_strain"],
  },
  {
    file: "loops.csv",
    title: "Loops of loading",
    about: "What each cycle took, and how much of it went where bonds broke.",
    over: "cycle",
    lines: ["energy_dissipated_j", "energy_released_by_breaking_j"],
    more: { allBut: [] },
    style: { hasPoints: true },
    leastRows: 2,
  },
  {
    file: "force_landscape_lines.csv",
    title: "Force landscape of a node",
    about: "Its resultant where it is moved along each axis, the other nodes in their places: balanced at zero.",
    over: "offset_mm",
    lines: ["resultant_along_x_n", "resultant_along_y_n", "resultant_along_z_n"],
    more: ["energy_along_x_n_mm", "energy_along_y_n_mm", "energy_along_z_n_mm"],
  },
  {
    file: "bond_law.csv",
    title: "Law of the bonds",
    about: "Force of a bond over its strain, pulled and pressed.",
    over: "bond_strain",
    lines: ["bond_force_n"],
    more: ["energy_per_length_n"],
  },
  {
    file: "breaking_by_force.csv",
    title: "Breaking by bond force",
    about: "How many bonds broke at which force.",
    over: ["bin_lower_n", "bin_upper_n"],
    lines: ["bonds"],
    more: ["energy_released_n_mm"],
  },
  {
    file: "breaking_by_strain.csv",
    title: "Breaking by strain",
    about: "How many bonds broke at which strain of the fabric.",
    over: ["nominal_strain_from", "nominal_strain_to"],
    lines: ["bonds"],
    more: ["energy_released_n_mm"],
  },
  {
    file: "faces/top.csv",
    title: "Displacement along the top face",
    about: "Of every particle of the face, from left to right.",
    over: "along_mm",
    lines: ["uy_mm"],
    more: ["ux_mm"],
    restsAt: "largest",
  },
  {
    file: "faces/bottom.csv",
    title: "Displacement along the bottom face",
    about: "Of every particle of the face, from left to right.",
    over: "along_mm",
    lines: ["uy_mm"],
    more: ["ux_mm"],
    restsAt: "largest",
  },
  {
    file: "beam_line.csv",
    title: "Beside Timoshenko's beam",
    about: "Mean displacement of every cross-section along y, and that of the beam the section is.",
    over: "x_mm",
    lines: ["uy_mm", "timoshenko_uy_mm"],
    restsAt: "largest",
  },
  {
    file: "convergence.csv",
    title: "Convergence over cells",
    about: "Each result on the grid asked for, and on those of half and of a quarter of its cells along both sides.",
    over: "cells_x",
    // each test has one of them
    lines: ["mean_top_deflection_mm", "flexural_modulus_mpa", "effective_modulus_mpa", "effective_shear_modulus_mpa"],
    more: { allBut: ["cells_y"] },
    style: { hasPoints: true, floats: true },
    leastRows: 2,
  },
  {
    file: "cell_convergence.csv",
    title: "Convergence over cells",
    about: "Each constant on the grid asked for, and on those of half and of a quarter of its cells along both sides.",
    over: "cells_per_fibre",
    lines: ["modulus_2_mpa"],
    more: { allBut: [] },
    style: { hasPoints: true, floats: true },
    leastRows: 2,
  },
  {
    file: "companions.csv",
    title: "Beside theory",
    about: "The cell's constants beside those that bounds and formulas give for its fibre fraction.",
  },
  {
    file: "cracks.csv",
    title: "Energy of breaks over displacement",
    about: "What each event dissipated, where it happened, and which part broke.",
    over: "displacement_mm",
    lines: ["dissipated_n_mm"],
    more: ["force_n", "energy_released_n_mm", "crack_area_mm2"],
    style: { floats: true },
    leastRows: 2,
  },
  {
    file: "points.csv",
    title: "Displacement of points",
    about: "Of the points that were asked for, at the end of the test.",
  },
];
