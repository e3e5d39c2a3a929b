// How wrong results may be, source by source.
import type { ErrorPart, Quantity } from "../api/types";
import { formatError } from "../format/numbers";
import { humanise, isWrong, unitFor, withUnit } from "../format/words";

type Basis = ErrorPart["basis"];

const BASES: Record<Basis, string> = {
  measured_table: "from a measured table",
  two_grids: "from coarser grids",
  two_solvers: "from another solver",
  repeats: "from repeats",
};

export interface Source {
  source: string;
  basis: string;
}

export interface ErrorTable {
  sources: Source[];
  /** Each result that has an error, with a text for each source; empty where that adds none. */
  rows: { name: string; parts: string[] }[];
}

/** The parts of all errors, a column for each source and where it is known from. */
export function errorTable(results: [name: string, quantity: Quantity][]): ErrorTable {
  const sources = new Map<string, Source>();
  const known = results.filter(([, quantity]) => isWrong(quantity));
  for (const part of known.flatMap(([, { error }]) => error?.parts ?? [])) {
    sources.set(keyOf(part), { source: humanise(part.source), basis: basisOf(part) });
  }
  const rows = known.map(([name, quantity]) => {
    const { factor, unit } = unitFor(name, quantity);
    const parts = new Map(quantity.error?.parts.map((part) => [keyOf(part), part.value / factor]));
    const text = (size: number | undefined): string => (size === undefined ? "" : withUnit(formatError(size), unit));
    return { name, parts: [...sources.keys()].map((key) => text(parts.get(key))) };
  });
  return { sources: [...sources.values()], rows };
}

function keyOf({ source, basis }: ErrorPart): string {
  return `${source} ${basis}`;
}

/** A server that is newer than this page may know another basis. */
function basisOf({ basis }: ErrorPart): string {
  return BASES[basis] ?? humanise(basis).toLowerCase();
}
