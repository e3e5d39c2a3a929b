// Colours of values: a ramp that grows lighter, or a colour for each name.
import { Color } from "three";
import type { Scalars } from "./frames";

/** Dark blue over green to yellow: readable without telling red from green, and in grey. */
const STOPS = ["#31356e", "#2c6a8f", "#2f9c8b", "#7cc66a", "#f2e14c"];
const RAMP = STOPS.map((text) => new Color(text));
/** The ramp as a background, mixed as the picture mixes it. */
export const RAMP_GRADIENT = `linear-gradient(in srgb-linear to right, ${STOPS.join(", ")})`;
/** Neighbouring numbers lie far apart on the circle of hues. */
const GOLDEN = 0.618034;

export function rangeOf({ values }: Scalars): [low: number, high: number] {
  let [low, high] = [Infinity, -Infinity];
  for (let index = 0; index < values.length; index++) {
    const value = values[index] ?? NaN;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

/** Part of the values beyond either end of the ramp, where some lie far out. */
const BEYOND = 0.01;

/** The values at the two ends of the ramp. */
export function rampOf(scalars: Scalars): [low: number, high: number] {
  if (!scalars.hasOutliers) return rangeOf(scalars);
  const sorted = Float64Array.from(scalars.values).sort();
  const last = sorted.length - 1;
  const [low, high] = [BEYOND, 1 - BEYOND].map((part) => sorted[Math.round(part * last)] ?? NaN);
  // A single thin fibre has fewer cells than are left aside.
  return low !== undefined && high !== undefined && high > low ? [low, high] : rangeOf(scalars);
}

/** Writes the colour of each value into a list, three numbers each. */
export function colourOf(scalars: Scalars | undefined, count: number): Float32Array {
  const colours = new Float32Array(3 * count);
  const colour = new Color();
  const [low, high] = scalars ? rampOf(scalars) : [0, 0];
  for (let index = 0; index < count; index++) {
    const value = scalars?.values[index] ?? NaN;
    if (!scalars || Number.isNaN(value)) colour.set("#8a938f");
    else if (scalars.isCategory) colour.setHSL((value * GOLDEN) % 1, 0.55, 0.58);
    else {
      const part = high > low ? Math.min(1, Math.max(0, (value - low) / (high - low))) : 0;
      const place = part * (RAMP.length - 1);
      const below = Math.min(Math.floor(place), RAMP.length - 2);
      colour.copy(RAMP[below] ?? colour).lerp(RAMP[below + 1] ?? colour, place - below);
    }
    colour.toArray(colours, 3 * index);
  }
  return colours;
}
