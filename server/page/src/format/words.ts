// Names on the wire as words for people.
import type { Job, Quantity } from "../api/types";
import { formatError, formatNumber, NARROW } from "./numbers";

/** `strain_at_max_force` as `strain at max force`, and `modulus_at_2_5_percent` as `modulus at 2.5 %`: the rule of the
 * program (`api/src/words.rs`), held to the same list. */
export function inWords(name: string): string {
  const numbers = name.replace(/(?<=(?:^|_)at_)(\d+)(?:_(\d+))?_percent(?=_|$)/g, (_, whole: string, part?: string) =>
    part === undefined ? `${whole} %` : `${whole}.${part} %`,
  );
  return numbers.replaceAll("_", " ");
}

/** The same as the beginning of a sentence: `Strain at max force`. */
export function humanise(name: string): string {
  const words = inWords(name);
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
  /** The standard error, all parts together: `± 0.02`. */
  error?: string;
  /** How far repeats scatter, or the 95 % interval of a fitted value; of what is not known, why. */
  scatter?: string;
}

/** A result as a lab reads it: strains in %, no unit for pure numbers. */
export function showQuantity(name: string, quantity: Quantity): Shown {
  const { value, reason, unit, deviation, n, error } = quantity;
  if (value === null) {
    const exact = `Unknown: ${reason ?? "the test did not get so far, or there was nothing to measure"}.`;
    return { text: "–", unit: "", exact, ...(reason && { scatter: reason }) };
  }
  const own = unit === "1" ? " (dimensionless)" : ` ${unit}`;
  const mean = deviation && n ? `, mean of ${n}, standard deviation ${deviation}` : "";
  const exact = `${value}${own}${mean}${error ? `, standard error ${error.value}` : ""}`;
  const { factor, unit: larger } = unitFor(name, quantity);
  const scatter = scatterOf(quantity, factor);
  const wrong = error && isWrong(quantity) && `± ${formatError(error.value / factor)}`;
  const text = formatNumber(value / factor);
  return { text, unit: larger, exact, ...(wrong && { error: wrong }), ...(scatter && { scatter }) };
}

/** The unit that a result is shown in, and what its value is divided by for that. */
export function unitFor(name: string, { value, unit }: Quantity): { factor: number; unit: string } {
  // A ratio of strains is not a strain.
  const isStrain = unit === "1" && /strain|stretch/.test(name) && !name.startsWith("anisotropy");
  const [factor, larger] = isStrain ? [0.01, "%"] : unit === "Pa" ? pascals(value ?? 0) : [1, unit];
  return { factor, unit: showUnit(larger) };
}

/** How far values lie apart, in the unit shown: of repeats their standard deviation, of a fitted value its interval. */
function scatterOf({ deviation, interval, n }: Quantity, factor: number): string {
  if (deviation && n) return `deviation ${formatError(deviation / factor)} of ${n}`;
  return interval ? interval.map((end) => formatNumber(end / factor)).join(" … ") : "";
}

/** Errors smaller than this part of a value are those of its last digits. */
const ROUND_OFF = 1e-12;

/** Whether a value has an error to speak of: what was given, such as a load, has none. */
export function isWrong({ value, error }: Pick<Quantity, "value" | "error">): boolean {
  return value !== null && (error?.value ?? 0) > ROUND_OFF * Math.abs(value);
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
