// What the schema has to say while text is written: which fields and words may stand here, and what a field means.
import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";
import type { EditorView, Tooltip } from "@codemirror/view";
import { describeField, hintOf, type FieldDoc, type Schema } from "../json/schema";
import { namesIn, placeAt } from "./places";

/** Fields that may be named and words that may be written at the caret. */
export function complete(schema: Schema | null, context: CompletionContext): CompletionResult | null {
  if (!schema) return null;
  const place = placeAt(context.state, context.pos);
  const isBegun = place.to > place.from;
  if (!isBegun && !context.explicit) return null;
  const doc = describeField(schema, place.path);
  if (!doc) return null;
  if (!place.isName) return offer(place, words(doc));
  const taken = place.object ? namesIn(context.state, place.object) : [];
  const typed = context.state.sliceDoc(place.from, place.to);
  const names = doc.fields.filter((name) => JSON.stringify(name) === typed || !taken.includes(name));
  // A name that has its colon keeps its value.
  const isNamed = /^\s*:/.test(context.state.sliceDoc(place.to, place.to + 20));
  return offer(
    place,
    names.map((name) => nameOption(schema, place.path, name, isNamed)),
  );
}

function offer({ from, to }: { from: number; to: number }, options: Completion[]): CompletionResult | null {
  return options.length === 0 ? null : { from, to, options, filter: true };
}

function nameOption(schema: Schema, path: string[], name: string, isNamed: boolean): Completion {
  const doc = describeField(schema, [...path, name]);
  const detail = doc ? hintOf(doc) : "";
  const quoted = JSON.stringify(name);
  return {
    label: quoted,
    displayLabel: name,
    type: "property",
    apply: isNamed ? quoted : `${quoted}: `,
    detail,
    info: doc?.description ?? "",
  };
}

function words(doc: FieldDoc): Completion[] {
  const booleans = doc.type.includes("boolean")
    ? [
        { value: "true", description: "" },
        { value: "false", description: "" },
      ]
    : [];
  const fallback = doc.default !== "" && doc.default.length < 40 && doc.options.length === 0 && booleans.length === 0;
  const standard = fallback ? [{ value: doc.default, description: "The default." }] : [];
  return [...doc.options, ...booleans, ...standard].map(({ value, description }) => ({
    label: value,
    type: "constant",
    info: description,
    detail: value === doc.default ? "default" : "",
  }));
}

/** What the field under the pointer means. */
export function explain(schema: Schema | null, view: EditorView, position: number, side: -1 | 1): Tooltip | null {
  if (!schema) return null;
  const { path, isName, from, to } = placeAt(view.state, position, side);
  if (to === from) return null;
  const named = isName ? unquoted(view.state.sliceDoc(from, to)) : null;
  const doc = describeField(schema, named === null ? path : [...path, named]);
  if (!doc?.description) return null;
  return { pos: from, end: to, create: () => ({ dom: tooltip(doc) }) };
}

function unquoted(text: string): string {
  return text.replace(/^"|"$/g, "");
}

function tooltip(doc: FieldDoc): HTMLElement {
  const dom = document.createElement("div");
  dom.className = "field-tooltip";
  for (const text of [doc.description, hintOf(doc)].filter(Boolean)) {
    dom.append(Object.assign(document.createElement("p"), { textContent: text }));
  }
  return dom;
}
