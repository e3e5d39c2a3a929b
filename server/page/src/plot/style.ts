// How lines and plots may look.

/** What a plot may do differently. */
export interface PlotStyle {
  /** The largest value of the main line is marked, and so are the cycles of a load that comes back. */
  marksMaximum?: boolean;
  /** Lines are as high as their values reach; otherwise zero belongs to their axis. */
  floats?: boolean;
  /** The first column by powers of ten; values that have none are left out. */
  isLogarithmic?: boolean;
  /** The first column goes upward, as a height does. */
  isUpright?: boolean;
  /** Few values that were measured one by one. */
  hasPoints?: boolean;
}

/** Gives the colour of a name such as `--ink` in the present light. */
export type Palette = (name: string) => string;

/** Dashes tell lines apart without colour; seven colours and four dashes repeat only together. */
const DASHES = [[], [6, 4], [2, 3], [9, 3, 2, 3]];
const COLOURS = 7;

export function seriesColour(index: number): string {
  return `--series-${(index % COLOURS) + 1}`;
}

export function seriesDash(index: number): number[] {
  return DASHES[index % DASHES.length] ?? [];
}
