// From a file's table to the lines of a plot.
import { indexOfMaximum } from "../plot/columns";
import { describe, stemOf, type Column } from "../plot/names";
import { numbers, type Table } from "./csv";
import type { FileTable } from "./tables";

export interface Drawing {
  /** The horizontal column first. */
  columns: Column[];
  values: number[][];
  cycles: number[] | undefined;
  unloading: number[] | undefined;
}

/** Nothing when the file is not for drawing, or lacks what is drawn. */
export function drawingOf(
  { over, lines = [], more = [], style }: FileTable,
  table: Table,
  beside?: Table,
): Drawing | null {
  if (over === undefined) return null;
  const edges = typeof over === "string" ? [over] : over;
  const ends = edges.map((name) => numbers(table, name));
  if (ends.some((end) => end === undefined)) return null;
  /** Rows that hold over an interval are drawn from its one end to its other. */
  const spread = (list: number[]): number[] => list.flatMap((value) => edges.map(() => value));
  const others = Array.isArray(more)
    ? more
    : table.columns.filter((name) => ![...edges, ...lines, ...more.allBut].includes(name));
  const named = [...lines, ...others].flatMap((name) => {
    const list = numbers(table, name);
    return list ? [{ column: { ...describe(name), isShown: lines.includes(name), isMinor: false }, list }] : [];
  });
  if (named.length === 0) return null;
  const first = describe(edges[0] ?? "");
  const column = edges.length > 1 ? { ...first, label: stemOf(first.label) } : first;
  const across = table.rows.flatMap((_, row) => ends.map((end) => (end?.[row] ?? NaN) * column.factor));
  // Rows of the two files belong together one by one, or not at all.
  const knowing = beside && beside.rows.length === table.rows.length ? beside : table;
  const whole = (name: string): number[] | undefined => {
    const list = numbers(knowing, name);
    return list && !edges.includes(name) ? spread(list) : undefined;
  };
  return {
    columns: [column, ...named.map(({ column }) => column)],
    values: [
      style?.isLogarithmic ? across.map((value) => (value > 0 ? value : NaN)) : across,
      ...named.map(({ column, list }) => spread(list.map((value) => value * column.factor))),
    ],
    cycles: whole("cycle"),
    unloading: whole("unloading"),
  };
}

/** The row whose values are told while nobody points at one. */
export function restingRow({ restsAt }: FileTable, { values: [across = [], main = []] }: Drawing): number {
  if (restsAt === "first") return 0;
  return restsAt === "largest" ? Math.max(0, indexOfMaximum(main.map(Math.abs))) : across.length - 1;
}
