// Which colour a line has: by what differs between the jobs.
import type { Differences } from "../api/types";
import { formatChosen, NARROW } from "../format/numbers";
import { humanise, showUnit } from "../format/words";
import { seriesColour } from "../plot/style";

/** Dark blue over green to yellow, as the colours of the pictures. */
const STOPS = ["#31356e", "#2c6a8f", "#2f9c8b", "#7cc66a", "#d9c92f"];
/** More different values than this are no longer told apart by colour, one by one. */
const MOST_COLOURS = 7;

/** How lines are coloured. */
export interface Colouring {
  /** A colour of the browser, or a name such as `--series-1`, for each job. */
  colours: string[];
  /** What the colours mean; of a ramp, its two ends and whether it is one. */
  legend: { colour: string; text: string }[];
  isRamp: boolean;
}

/** Something that differs from job to job. */
export interface Quality {
  key: string;
  label: string;
  unit: string;
  values: unknown[];
}

/** All that jobs can be coloured by: fields first, then results. */
export function qualitiesOf({ fields, results }: Differences): Quality[] {
  return [
    ...fields.map(({ pointer, unit, values }) => ({
      key: pointer,
      label: pointerLabel(pointer),
      unit: showUnit(unit ?? "1"),
      values,
    })),
    ...results.map(({ name, unit, values }) => ({
      key: resultKey(name, unit),
      label: humanise(name),
      unit: showUnit(unit),
      values,
    })),
  ];
}

/** What a result is called in addresses: one name may have two units. */
export function resultKey(name: string, unit: string): string {
  return `${name} [${unit}]`;
}

/** `/spec/bond/modulus_n` as `bond.modulus_n`, as the guide writes fields. */
export function pointerLabel(pointer: string): string {
  const parts = pointer.replace(/^\/(spec\/)?/, "").split("/");
  return parts.map((part) => part.replaceAll("~1", "/").replaceAll("~0", "~")).join(".");
}

/** A value as a person reads it. */
export function tell(value: unknown): string {
  if (value === null || value === undefined) return "–";
  if (typeof value === "number") return formatChosen(value);
  return typeof value === "string" ? value : JSON.stringify(value);
}

/** Colours of `count` jobs by a quality; by their place where there is none. */
export function colouring(quality: Quality | undefined, names: string[]): Colouring {
  if (!quality) {
    const colours = names.map((_, index) => seriesColour(index));
    const legend = names.length <= MOST_COLOURS ? names : [];
    return { colours, legend: legend.map((text, index) => ({ colour: seriesColour(index), text })), isRamp: false };
  }
  const numbers = quality.values.filter((value) => typeof value === "number");
  const different = [...new Set(quality.values.map((value) => JSON.stringify(value ?? null)))];
  const isRamp = different.length > MOST_COLOURS && numbers.length > 0;
  if (isRamp) {
    const [low, high] = [Math.min(...numbers), Math.max(...numbers)];
    const part = (value: number): number => (high > low ? (value - low) / (high - low) : 0);
    const colours = quality.values.map((value) => (typeof value === "number" ? ramp(part(value)) : "--muted"));
    const ends = [low, high].map((value) => ({ colour: ramp(part(value)), text: withUnit(value, quality.unit) }));
    return { colours, legend: ends, isRamp };
  }
  const sorted = different.toSorted(byValue);
  const colours = quality.values.map((value) => seriesColour(sorted.indexOf(JSON.stringify(value ?? null))));
  const legend = sorted.slice(0, MOST_COLOURS).map((text, index) => ({
    colour: seriesColour(index),
    text: withUnit(JSON.parse(text) as unknown, quality.unit),
  }));
  return { colours, legend, isRamp };
}

/** The ramp as a background. */
export const RAMP = `linear-gradient(to right, ${STOPS.join(", ")})`;

function withUnit(value: unknown, unit: string): string {
  return typeof value === "number" && unit !== "" ? `${tell(value)}${NARROW}${unit}` : tell(value);
}

/** Numbers by size, texts by letter. */
function byValue(a: string, b: string): number {
  const [x, y] = [Number(a), Number(b)];
  return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b) : x - y;
}

/** The colour at a part of the ramp. */
export function ramp(part: number): string {
  const place = Math.min(1, Math.max(0, part)) * (STOPS.length - 1);
  const below = Math.min(Math.floor(place), STOPS.length - 2);
  const [from, to] = [STOPS[below] ?? "", STOPS[below + 1] ?? ""].map(channels);
  const mixed = (from ?? []).map((value, index) => Math.round(value + ((to?.[index] ?? 0) - value) * (place - below)));
  return `#${mixed.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

function channels(colour: string): number[] {
  return [1, 3, 5].map((place) => parseInt(colour.slice(place, place + 2), 16));
}
