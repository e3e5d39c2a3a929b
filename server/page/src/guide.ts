// Addresses in the guide, which the server serves beside this page.

export const GUIDE = "/guide";

/** The page on a kind of job. */
export function guideToKind(kind: string): string {
  return `${GUIDE}/${encodeURIComponent(kind)}`;
}

/** A kind's list of fields, at one of them (`test.strain_step`) when it is named. */
export function guideToField(kind: string, field: string): string {
  return `${guideToKind(kind)}/fields${field === "" ? "" : `#${field}`}`;
}

/** What a warning or a check of quality means, and what to do. */
export function guideToQuality(name: string): string {
  return `${GUIDE}/quality#${name}`;
}
