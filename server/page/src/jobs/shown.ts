// What the list shows of results and specs, and in which order the jobs stand: those that it has by name, time or key
// result, all of the server by a value.
import type { Job, Quantity } from "../api/types";
import { formatChosen } from "../format/numbers";
import { humanise, showQuantity } from "../format/words";

export const ORDERS = ["", "name", "result", "time", "value"] as const;
export type Order = (typeof ORDERS)[number];

export interface Shown {
  /** Name of the result; empty for the first of each job, which is what its lab asks for first. */
  result: string;
  /** What jobs are sorted by; empty as the server lists them, the newest first. */
  order: Order;
  isFalling: boolean;
  /** What the server sorts by, a pointer, where the order is by a value. */
  pointer: string;
  /** Pointers to values of specs and results that have columns. */
  columns: string[];
}

/** A value of a job, for reading. */
export interface ShownValue {
  text: string;
  unit: string;
}

/** A pointer for reading: `max force`, `test.max_strain`. */
export function labelOf(pointer: string): string {
  const parts = pointer.split("/").slice(2);
  const text = parts.map((part) => part.replaceAll("~1", "/").replaceAll("~0", "~")).join(".");
  return pointer.startsWith("/summary/") ? humanise(text) : text;
}

/** What a job has at a pointer. */
export function valueOf({ summary, values }: Job, pointer: string): ShownValue | null {
  if (pointer.startsWith("/summary/")) {
    const name = pointer.slice("/summary/".length).replaceAll("~1", "/").replaceAll("~0", "~");
    const quantity = summary?.[name];
    return quantity ? showQuantity(name, quantity) : null;
  }
  const found = values?.[pointer];
  if (!found) return null;
  const { value, unit } = found;
  const text = typeof value === "number" ? formatChosen(value) : String(value);
  return { text, unit: unit ?? "" };
}

/** What the server is to sort by; empty for the newest first. */
export function sortOf({ order, isFalling, pointer }: Shown): string {
  return order === "value" ? `${isFalling ? "-" : ""}${pointer}` : "";
}

/** Names of all results that these jobs have, in the order of the jobs. */
export function resultNames(jobs: Job[]): string[] {
  return [...new Set(jobs.flatMap(({ summary }) => Object.keys(summary ?? {})))];
}

/** The result that is shown of a job, with its name. */
export function resultOf({ summary }: Job, name: string): { name: string; quantity: Quantity } | null {
  const key = name === "" ? Object.keys(summary ?? {})[0] : name;
  const quantity = key === undefined ? undefined : summary?.[key];
  return key !== undefined && quantity ? { name: key, quantity } : null;
}

/** The jobs in the order asked for; those that have nothing to sort by come last, either way. */
export function inOrder(jobs: Job[], { result, order, isFalling }: Shown): Job[] {
  if (order === "" || order === "value") return jobs;
  const value = (job: Job): string | number | null => {
    if (order === "name") return job.name.toLowerCase();
    if (order === "result") return resultOf(job, result)?.quantity.value ?? null;
    if (job.started_at === null || job.finished_at === null) return null;
    return Date.parse(job.finished_at) - Date.parse(job.started_at);
  };
  return jobs.toSorted((a, b) => {
    const [x, y] = [value(a), value(b)];
    if (x === null || y === null) return Number(x === null) - Number(y === null);
    const rising = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y));
    return isFalling ? -rising : rising;
  });
}

/** Sorts by a column; pressed again, the other way round; a third time, as the server lists them. */
export function pressed(shown: Shown, order: Order, pointer = ""): Shown {
  if (shown.order !== order || shown.pointer !== pointer) return { ...shown, order, pointer, isFalling: false };
  return shown.isFalling ? { ...shown, order: "", pointer: "", isFalling: false } : { ...shown, isFalling: true };
}

/** Columns that are shown at most, as the server gives them. */
export const MOST_COLUMNS = 12;

const isPointer = (text: string): boolean => /^\/(spec|summary)\/./.test(text);

/** What an address says of it. */
export function readShown(query: URLSearchParams): Shown {
  const sort = query.get("sort") ?? "";
  const by = sort.replace(/^-/, "");
  const order = isPointer(by) ? "value" : (ORDERS.find((one) => one === by && one !== "value") ?? "");
  const columns = (query.get("show") ?? "").split(",").filter(isPointer).slice(0, MOST_COLUMNS);
  return {
    result: query.get("result") ?? "",
    order,
    isFalling: order !== "" && sort.startsWith("-"),
    pointer: order === "value" ? by : "",
    columns,
  };
}

/** The part of an address that says it. */
export function writeShown({ result, order, isFalling, pointer, columns }: Shown): [string, string][] {
  const all: [string, string][] = [
    ["result", result],
    ["sort", order && `${isFalling ? "-" : ""}${order === "value" ? pointer : order}`],
    ["show", columns.join(",")],
  ];
  return all.filter(([, value]) => value !== "");
}
