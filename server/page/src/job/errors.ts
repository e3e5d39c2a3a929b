// How wrong results may be, source by source.
import type { ErrorPart, Quantity } from "../api/types";
import { formatError } from "../format/numbers";
import { formatDuration } from "../format/time";
import { humanise, isWrong, unitFor, withUnit } from "../format/words";

type Basis = ErrorPart["basis"];

const BASES: Record<Basis, string> = {
  measured_table: "from a measured table",
  two_grids: "from coarser grids",
  two_solvers: "from another solver",
  repeats: "from repeats",
  propagated: "by that of another result",
};

export interface Source {
  source: string;
  basis: string;
}

/** What makes the part of one source a tenth, and the time for it. */
export interface Tenth {
  source: string;
  change: string;
  time: string;
}

export interface ErrorTable {
  sources: Source[];
  tenths: Tenth[];
  /** Each result that has an error, with a text for each source; empty where that adds none. */
  rows: { name: string; parts: string[] }[];
}

/** The parts of all errors, a column for each source and where it is known from. */
export function errorTable(results: [name: string, quantity: Quantity][], wallSeconds?: number): ErrorTable {
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
  return { sources: [...sources.values()], rows, tenths: tenthsOf(known, wallSeconds) };
}

/** The changes that buy a digit, each once. */
function tenthsOf(results: [name: string, quantity: Quantity][], wallSeconds?: number): Tenth[] {
  const found = new Map<string, Tenth>();
  for (const { source, tenth } of results.flatMap(([, { error }]) => error?.parts ?? [])) {
    if (tenth && wallSeconds !== undefined) {
      const time = formatDuration(tenth.time_factor * wallSeconds);
      found.set(`${source} ${tenth.change}`, { source: humanise(source), change: tenth.change, time });
    }
  }
  return [...found.values()];
}

function keyOf({ source, basis }: ErrorPart): string {
  return `${source} ${basis}`;
}

/** A server that is newer than this page may know another basis. */
function basisOf({ basis }: ErrorPart): string {
  return BASES[basis] ?? humanise(basis).toLowerCase();
}
