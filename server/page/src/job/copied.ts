// Results for a spreadsheet: all digits and the units of the file, between tabs.
import type { Quantity } from "../api/types";

const NAMES = ["name", "value", "unit", "deviation", "n", "error", "reason"];

export function tabbed(results: [name: string, quantity: Quantity][]): string {
  const lines = results.map(([name, { value, unit, deviation, n, error, reason }]) =>
    [name, value, unit, deviation, n, error?.value, reason].map((cell) => cell ?? "").join("\t"),
  );
  return [NAMES.join("\t"), ...lines].join("\n");
}
