import type { Snippet } from "svelte";
import type { JsonNode } from "../json/scan";
import type { Form } from "./form.svelte";
import type { Field } from "./model";

/** What a field's component is given. */
export interface FieldProps {
  form: Form;
  field: Field;
  /** Keys and indices from the root of the job. */
  path: string[];
  /** Its value in the text, if it is given. */
  node: JsonNode | undefined;
}

/** Draws a field within another, whatever shape it has. */
export type Draw = Snippet<[field: Field, path: string[], node: JsonNode | undefined]>;
