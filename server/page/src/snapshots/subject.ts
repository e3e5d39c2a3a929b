// What the snapshots of a test are of, and what their moments are called.
import type { Job } from "../api/types";
import { formatNumber } from "../format/numbers";
import { withUnit } from "../format/words";

/**
 * Bodies in time, bonds over strain, fibres of a sheet over strain, the springs of one fibre, or the face of a
 * section: under its load, while it breaks, at the end of a motion, or of fibres seen from their ends. Of a
 * kind that is not known here it is a picture, whose moments are numbers without a unit.
 */
export type Subject =
  | "picture"
  | "scene"
  | "fabric"
  | "sheet"
  | "fibre"
  | "loaded section"
  | "breaking section"
  | "moved section"
  | "cell section";

/** How kinds begin whose snapshots are of grains. */
const OF_GRAINS = ["granular_", "triaxial", "direct_shear", "ballast_"];

export function subjectOf({ kind, spec }: Pick<Job, "kind" | "spec">): Subject {
  if (kind.startsWith("nonwoven")) return "fabric";
  if (kind === "paper_tensile") {
    const specimen = (spec as { specimen?: { single_fibre?: unknown } } | undefined)?.specimen;
    return specimen?.single_fibre ? "fibre" : "sheet";
  }
  if (OF_GRAINS.some((beginning) => kind.startsWith(beginning))) return "scene";
  if (!kind.startsWith("composite")) return "picture";
  if (kind === "composite_cell") return "cell section";
  const test = (spec as { test?: { history?: unknown; breaking?: unknown } } | undefined)?.test;
  if (test?.breaking) return "breaking section";
  return test?.history ? "moved section" : "loaded section";
}

export function isSection(subject: Subject): boolean {
  return subject.endsWith("section");
}

/** A moment in words, from its number in the list of snapshots. */
export function momentOf(at: number, subject: Subject): string {
  switch (subject) {
    case "scene":
      return withUnit(formatNumber(at), "s");
    case "picture":
    case "fibre":
      return `at ${formatNumber(at)}`;
    case "fabric":
    case "sheet":
      return withUnit(formatNumber(100 * at), "% strain");
    case "loaded section":
      return at === 1 ? "full load" : withUnit(formatNumber(100 * at), "% of the load");
    case "breaking section":
      return `at ${withUnit(formatNumber(at), "mm")}`;
    case "cell section":
      return "pulled across the fibres by 1 MPa";
    case "moved section":
      return at === 1 ? "at the end" : withUnit(formatNumber(100 * at), "% of the time");
  }
}
