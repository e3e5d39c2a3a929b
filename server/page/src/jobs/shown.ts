// Which result the list shows, and in which order the jobs that it has stand.
import type { Job, Quantity } from "../api/types";

export const ORDERS = ["", "name", "result", "time"] as const;
export type Order = (typeof ORDERS)[number];

export interface Shown {
  /** Name of the result; empty for the first of each job, which is what its lab asks for first. */
  result: string;
  /** What jobs are sorted by; empty as the server lists them, the newest first. */
  order: Order;
  isFalling: boolean;
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
  if (order === "") return jobs;
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
export function pressed(shown: Shown, order: Order): Shown {
  if (shown.order !== order) return { ...shown, order, isFalling: false };
  return shown.isFalling ? { ...shown, order: "", isFalling: false } : { ...shown, isFalling: true };
}

/** What an address says of it. */
export function readShown(query: URLSearchParams): Shown {
  const sort = query.get("sort") ?? "";
  const order = ORDERS.find((one) => one === sort.replace(/^-/, "")) ?? "";
  return { result: query.get("result") ?? "", order, isFalling: order !== "" && sort.startsWith("-") };
}

/** The part of an address that says it. */
export function writeShown({ result, order, isFalling }: Shown): [string, string][] {
  const all: [string, string][] = [
    ["result", result],
    ["sort", order && `${isFalling ? "-" : ""}${order}`],
  ];
  return all.filter(([, value]) => value !== "");
}
