// A curve that turns back: the order the plot needs, and the branches it is drawn in.

export interface Order {
  /** Rows by the horizontal value, ascending; rows without one are left out. */
  rows: number[];
  /** Whether the curve goes left anywhere, so that this is not the order of time. */
  turnsBack: boolean;
}

export function orderAlong(horizontal: number[]): Order {
  const rows = [...horizontal.keys()].filter((row) => Number.isFinite(horizontal[row]));
  const at = (row: number | undefined): number => (row === undefined ? -Infinity : (horizontal[row] ?? NaN));
  const turnsBack = rows.some((row, index) => at(row) < at(rows[index - 1]));
  // Rows of one value keep the order of time.
  if (turnsBack) rows.sort((a, b) => at(a) - at(b));
  return { rows, turnsBack };
}

/** Consecutive rows of one cycle, all loading or all unloading. */
export interface Branch {
  first: number;
  last: number;
  cycle: number;
  isUnloading: boolean;
}

/** The branches of a curve in the order of time; each begins where the one before it ends. */
export function branchesOf(count: number, cycles: number[] | undefined, unloading: number[] | undefined): Branch[] {
  const branches: Branch[] = [];
  let current: Branch | undefined;
  for (let row = 0; row < count; row++) {
    const cycle = cycles?.[row] ?? 1;
    const isUnloading = (unloading?.[row] ?? 0) > 0;
    if (!current || current.cycle !== cycle || current.isUnloading !== isUnloading) {
      current = { first: Math.max(0, row - 1), last: row, cycle, isUnloading };
      branches.push(current);
    }
    current.last = row;
  }
  return branches;
}

/** How a curve runs. */
export interface Course {
  /** Values in the order of time, one list for each column. */
  values: number[][];
  turnsBack: boolean;
  branches: Branch[];
}
