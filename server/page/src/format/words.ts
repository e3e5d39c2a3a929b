// Names on the wire as words for people.
import type { Job, Quantity } from "../api/types";
import { formatChosen, formatNumber, NARROW } from "./numbers";

/** `strain_at_max_force` as `Strain at max force`. */
export function humanise(name: string): string {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** A reason as it came (lower case, no full stop) as a sentence. */
export function sentence(text: string): string {
  const trimmed = text.trim();
  return trimmed.charAt(0).toUpperCase() + trimmed.slice(1) + (/[.!?]$/.test(trimmed) || trimmed === "" ? "" : ".");
}

/** A job's state in one word: how it ended, once it has. */
export function stateOf(job: Job): string {
  if (job.status !== "finished") {
    if (job.reason_code === "cancel_requested") return "cancelling";
    if (job.reason_code === "pause_requested") return "pausing";
    return job.status;
  }
  return job.outcome ?? "finished";
}

export interface Shown {
  text: string;
  unit: string;
  /** The value as it came, for the tooltip. */
  exact: string;
  /** The standard deviation over repeats, or the 95 % interval of a fitted value. */
  scatter?: string;
}

/** A result as a lab reads it: strains in %, no unit for pure numbers. */
export function showQuantity(name: string, quantity: Quantity): Shown {
  const { value, unit } = quantity;
  // A ratio of strains is not a strain.
  const isStrain = unit === "1" && /strain|stretch/.test(name) && !name.startsWith("anisotropy");
  if (value === null) return { text: "–", unit: "", exact: "The test did not get far enough to know." };
  const { deviation, interval, n } = quantity;
  const mean = deviation && n ? `, mean of ${n}, standard deviation ${deviation}` : "";
  const exact = `${value}${unit === "1" ? " (dimensionless)" : ` ${unit}`}${mean}`;
  const [factor, larger] = isStrain ? [0.01, "%"] : unit === "Pa" ? pascals(value) : [1, unit];
  // Two digits tell how far specimens differ.
  const fitted = !mean && interval ? interval.map((end) => formatNumber(end / factor)).join(" … ") : "";
  const scatter = mean ? `± ${formatChosen(Number(((deviation ?? 0) / factor).toPrecision(2)))}` : fitted;
  return { text: formatNumber(value / factor), unit: showUnit(larger), exact, ...(scatter && { scatter }) };
}

/** Nobody speaks of 68 860 000 Pa. */
function pascals(value: number): [factor: number, unit: string] {
  const size = Math.abs(value);
  return size >= 1e5 ? [1e6, "MPa"] : size >= 1e2 ? [1e3, "kPa"] : [1, "Pa"];
}

/** `N m/g` with real products and powers: `N·m/g`, `J/m²`. */
export function showUnit(unit: string): string {
  if (unit === "1") return "";
  return unit
    .replaceAll(" ", "·")
    .replace(/(?<=[a-z])\^?2/g, "²")
    .replace(/(?<=[a-z])\^?3/g, "³");
}

/** Value and unit in one text. */
export function withUnit(text: string, unit: string): string {
  return unit === "" ? text : `${text}${NARROW}${unit}`;
}
