// Where a new job starts from: the examples of every kind, or a job there is.
import { getJson } from "../api/client";
import type { Example, Job, Kind, Page } from "../api/types";
import { formatJson } from "../format/json";

export interface ExampleGroup {
  kind: Kind;
  examples: Example[];
}

export async function readExamples(): Promise<ExampleGroup[]> {
  const kinds = (await getJson<Page<Kind>>("/v1/kinds")).items;
  return Promise.all(
    kinds.map(async (kind) => {
      const path = `/v1/kinds/${encodeURIComponent(kind.kind)}/examples`;
      return { kind, examples: (await getJson<Page<Example>>(path)).items };
    }),
  );
}

/** The text that would submit a job again. */
export async function readVariation(id: string): Promise<string> {
  const job = await getJson<Job>(`/v1/jobs/${encodeURIComponent(id)}`);
  const { kind, name, notes, tags, priority, spec } = job;
  return `${formatJson({ kind, name: `${name} (variation)`.trim(), notes, tags, priority, spec })}\n`;
}
