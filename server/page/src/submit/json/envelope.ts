// The schema of a whole job: what stands around the spec is the same for every kind.
import type { Kind } from "../../api/types";
import type { Schema } from "./schema";

/** A job of a kind; without the spec's schema, of any spec. As `Submission` in the server's OpenAPI document. */
export function schemaOfJob(kinds: Kind[], spec: Schema | null): Schema {
  return {
    type: "object",
    required: ["kind", "spec"],
    properties: {
      kind: {
        description: "Which test is run. Each kind has its own spec.",
        oneOf: kinds.map(({ kind, title }) => ({ type: "string", const: kind, description: title })),
      },
      name: {
        type: "string",
        description: "What the job is called in the list. Free text; left out, the kind's title.",
        maxLength: 200,
        default: "",
      },
      notes: {
        type: "string",
        description: "Whatever should be remembered with the result.",
        maxLength: 10_000,
        default: "",
      },
      tags: {
        type: "array",
        description: "Words to find the job by.",
        items: { type: "string", minLength: 1, maxLength: 50 },
        maxItems: 20,
        default: [],
      },
      priority: {
        type: "integer",
        description: "Higher ones run first; equal ones in the order of submission.",
        minimum: -1000,
        maximum: 1000,
        default: 0,
      },
      overrun_factor: {
        type: "number",
        description: "How many times its estimated time, memory and files the job may take before it is paused.",
        minimum: 1,
        maximum: 1_000_000,
        default: 10,
      },
      spec: spec ?? {
        type: "object",
        description: "The test itself: specimen, materials, what is done, how exactly, what is written.",
      },
    },
  };
}
