// Tables as the engine writes them: a row of names, commas, dot decimals, nothing quoted.

export interface Table {
  columns: string[];
  /** Cells as they stand in the file; what is not known is empty. */
  rows: string[][];
}

export function parseCsv(text: string): Table {
  const lines = text.split(/\r?\n/).filter((line) => line !== "");
  const [columns = [], ...rows] = lines.map((line) => line.split(","));
  return { columns, rows };
}

/** A column of words; nothing when the table has no such column. */
export function words(table: Table, name: string): string[] | undefined {
  const index = table.columns.indexOf(name);
  return index < 0 ? undefined : table.rows.map((row) => row[index] ?? "");
}

/** A column of numbers, NaN where none is known; nothing when the table has no such column. */
export function numbers(table: Table, name: string): number[] | undefined {
  return words(table, name)?.map(toNumber);
}

export function toNumber(cell: string): number {
  return cell.trim() === "" ? NaN : Number(cell);
}
