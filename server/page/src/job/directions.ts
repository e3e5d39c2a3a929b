// Results of a specimen pulled in two directions stand side by side.
import type { Quantity } from "../api/types";
import { showQuantity, type Shown } from "../format/words";

export interface Row {
  name: string;
  description: string;
  /** The value, and beside it that of the second direction where there is one. */
  shown: Shown[];
}

const SECOND = /^(.+)_along_([xy])$/;

/** The rows of a result table, and the axis of the second direction where the test had one. */
export function byDirection(results: [name: string, quantity: Quantity][]): { second: string | null; rows: Row[] } {
  let second: string | null = null;
  const rows = new Map<string, Row>();
  for (const [name, quantity] of results) {
    const [, first = "", axis = null] = SECOND.exec(name) ?? [];
    const row = rows.get(first);
    if (row) {
      second = axis;
      row.shown.push(showQuantity(first, quantity));
    } else {
      rows.set(name, { name, description: quantity.description ?? "", shown: [showQuantity(name, quantity)] });
    }
  }
  return { second, rows: [...rows.values()] };
}
