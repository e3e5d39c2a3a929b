// Allocations of a batch system, counted.
import type { ReportedAllocations } from "../api/types";

/** "3 allocations: 2 running, 1 pending (Priority)": every state with the reasons for waiting in it. */
export function counted(allocations: ReportedAllocations["allocations"]): string {
  if (allocations.length === 0) {
    return "no allocations";
  }
  const states = new Map<string, { count: number; reasons: Set<string> }>();
  for (const { state, reason } of allocations) {
    const entry = states.get(state) ?? { count: 0, reasons: new Set<string>() };
    entry.count += 1;
    if (reason) {
      entry.reasons.add(reason);
    }
    states.set(state, entry);
  }
  const parts = [...states].map(([state, { count, reasons }]) => {
    const why = reasons.size > 0 ? ` (${[...reasons].join(", ")})` : "";
    return `${count} ${state.toLowerCase()}${why}`;
  });
  const noun = allocations.length === 1 ? "allocation" : "allocations";
  return `${allocations.length} ${noun}: ${parts.join(", ")}`;
}
