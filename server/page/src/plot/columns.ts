// Which columns are drawn, over which, and which line a plot is about.
import { describeAll, type Column } from "./names";

/** Columns in the order drawn, the horizontal one first; at least one line is shown strong. */
export function describeColumns(names: string[]): Column[] {
  const columns = describeAll(names);
  const second = columns[1];
  if (second && !columns.some(isStrong)) Object.assign(second, { isShown: true, isMinor: false });
  return columns;
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

/** Index of the largest value; -1 when there is none. */
export function indexOfMaximum(values: number[]): number {
  let best = -1;
  values.forEach((value, index) => {
    if (Number.isFinite(value) && (best < 0 || value > (values[best] ?? -Infinity))) best = index;
  });
  return best;
}
