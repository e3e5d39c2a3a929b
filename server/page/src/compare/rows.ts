// The table: what differs, all results, and how far they are from those of a reference.
import type { ComparedJob, Differences } from "../api/types";
import { formatNumber, NARROW } from "../format/numbers";
import { humanise, unitFor } from "../format/words";
import { qualitiesOf, tell } from "./colours";
import { areaBetween, type Line } from "./curves";

export interface TableColumn {
  key: string;
  label: string;
  unit: string;
  isNumber: boolean;
  /** For each job: a number or a text to sort by, and what is shown. */
  cells: { order: number | string | null; text: string; exact: string }[];
}

/** Columns of the table; beside each result its difference to the reference where there is one. */
export function columnsOf(differences: Differences, lines: Line[], reference: string, areaUnit: string): TableColumn[] {
  const { jobs } = differences;
  const at = jobs.findIndex(({ id }) => id === reference);
  const results = new Set(differences.results.map(({ name, unit }) => `${name} [${unit}]`));
  const columns: TableColumn[] = [];
  for (const { key, label, unit, values } of qualitiesOf(differences)) {
    if (!results.has(key)) {
      const cells = values.map((value) => ({ order: orderOf(value), text: tell(value), exact: exactOf(value) }));
      columns.push({ key, label, unit, isNumber: values.some((value) => typeof value === "number"), cells });
      continue;
    }
    columns.push(resultColumn(differences, key));
    if (at >= 0) columns.push(differenceColumn(key, label, values, at));
  }
  const base = lines.find(({ id }) => id === reference);
  if (base) columns.push(areaColumn(jobs, lines, base, areaUnit));
  return columns;
}

function resultColumn({ results }: Differences, key: string): TableColumn {
  const result = results.find(({ name, unit }) => `${name} [${unit}]` === key);
  const { name = "", unit: own = "", values = [] } = result ?? {};
  // One unit for all of a column: that of its largest value.
  const sizes = values.filter((value) => value !== null).map(Math.abs);
  const { factor, unit } = unitFor(name, { value: Math.max(0, ...sizes), unit: own, description: "" });
  const cells = values.map((value) => ({
    order: value,
    text: value === null ? "–" : formatNumber(value / factor),
    exact: value === null ? "" : `${value} ${own}`,
  }));
  return { key, label: humanise(name), unit, isNumber: true, cells };
}

/** By how much each is above the reference, as a part of it. */
function differenceColumn(key: string, label: string, values: unknown[], at: number): TableColumn {
  const base = values[at];
  const cells = values.map((value) => {
    const part =
      typeof value === "number" && typeof base === "number" && base !== 0 ? (value - base) / Math.abs(base) : null;
    return { order: part, text: part === null ? "–" : percent(part), exact: part === null ? "" : String(part) };
  });
  return { key: `difference ${key}`, label: `Δ ${label}`, unit: "%", isNumber: true, cells };
}

function areaColumn(jobs: ComparedJob[], lines: Line[], base: Line, unit: string): TableColumn {
  const byId = new Map(lines.map((line) => [line.id, line]));
  const cells = jobs.map(({ id }) => {
    const line = byId.get(id);
    const area = line ? areaBetween(line, base) : NaN;
    const isKnown = Number.isFinite(area);
    return {
      order: isKnown ? area : null,
      text: isKnown ? formatNumber(area) : "–",
      exact: isKnown ? String(area) : "",
    };
  });
  return { key: "area", label: "Area between the curves", unit, isNumber: true, cells };
}

function percent(part: number): string {
  const text = formatNumber(100 * part, 3);
  return part > 0 ? `+${text}` : text;
}

function orderOf(value: unknown): number | string | null {
  if (typeof value === "number") return value;
  return value === null || value === undefined ? null : tell(value);
}

function exactOf(value: unknown): string {
  return value === null || value === undefined ? "null or absent" : JSON.stringify(value);
}

/** Places of the jobs in the order of a column; what has no value comes last, either way. */
export function ordered(column: TableColumn | undefined, count: number, isFalling: boolean): number[] {
  const places = Array.from({ length: count }, (_, place) => place);
  if (!column) return isFalling ? places.toReversed() : places;
  return places.toSorted((a, b) => {
    const [x, y] = [column.cells[a]?.order ?? null, column.cells[b]?.order ?? null];
    if (x === null || y === null) return Number(x === null) - Number(y === null) || a - b;
    const rising = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y));
    return (isFalling ? -rising : rising) || a - b;
  });
}

/** The table as CSV: a row of names with units, then full digits. */
export function csvOf(jobs: ComparedJob[], columns: TableColumn[], differences: Differences): string {
  const raw = qualitiesOf(differences);
  const names = ["job", "name", ...raw.map(({ key }) => key)];
  const rows = jobs.map((job, place) => [job.id, job.name, ...raw.map(({ values }) => plain(values[place]))]);
  const extra = columns.filter(({ key }) => key === "area");
  extra.forEach(({ key, unit, cells }) => {
    names.push(`${key} [${unit.replaceAll(NARROW, " ")}]`);
    rows.forEach((row, place) => row.push(cells[place]?.exact ?? ""));
  });
  return [names, ...rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";
}

function plain(value: unknown): string {
  if (value === null || value === undefined) return "";
  return typeof value === "string" ? value : JSON.stringify(value);
}

/** A cell that no spreadsheet takes for a formula. */
function cell(text: string): string {
  const isNumber = /^[-+]?[\d.]/.test(text) && Number.isFinite(Number(text));
  const harmless = !isNumber && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\n\r]/.test(harmless) ? `"${harmless.replaceAll('"', '""')}"` : harmless;
}
