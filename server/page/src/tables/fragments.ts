// Mass curves of fragments, from their shares of the mass by class of size.
import { MASS_SHARE } from "../plot/names";
import { numbers, words, type Table } from "./csv";

/**
 * A row for each class of fragments, a column for each moment: the share of the mass in fragments
 * of at most so many spheres. Curves end with the largest fragment of all moments.
 */
export function massCurves(table: Table): Table {
  const moments = words(table, "moment") ?? [];
  const largest = Math.max(0, ...(numbers(table, "largest_fragment_members") ?? []));
  const sums = moments.map(() => 0);
  const rows: string[][] = [];
  for (const name of table.columns) {
    const [isClass, isOpen, first, last = isOpen ? Infinity : first] = MASS_SHARE.exec(name) ?? [];
    if (!isClass || Number(first) > largest) continue;
    numbers(table, name)?.forEach((share, moment) => (sums[moment] = (sums[moment] ?? 0) + share));
    rows.push([Math.min(Number(last), largest), ...sums].map(String));
  }
  return { columns: ["fragment_members", ...moments.map((moment) => `finer_${moment}`)], rows };
}
