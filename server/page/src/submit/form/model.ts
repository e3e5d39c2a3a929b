// The fields of a form, made from a JSON Schema once for each kind. It knows no text, no values and no components.
import { humanise } from "../../format/words";
import { docOf, list, object, type FieldDoc, type Schema } from "../json/schema";

export interface Field {
  /** Its key; of entries of lists and maps, empty. */
  name: string;
  label: string;
  doc: FieldDoc;
  /** Whether it is a part that may be switched off as a whole. */
  isPart: boolean;
  shape: Shape;
}

export type Shape =
  | { is: "number" }
  | { is: "text"; isLong: boolean }
  | { is: "flag" }
  /** Fields of an object, in the schema's order. */
  | { is: "group"; fields: Field[] }
  /** Entries under names that the person gives. */
  | { is: "map"; entry: Field }
  | { is: "list"; entry: Field; shortest: number; longest: number }
  | { is: "choice"; options: Option[] }
  /** What the schema leaves open: written as text only. */
  | { is: "any" };

/** One of several things that a value may be. */
export interface Option {
  label: string;
  about: string;
  /** The JSON text of a word that is chosen as it is; empty for a value with fields of its own. */
  word: string;
  /** The key under which the value stands (`{"lattice": ...}`); empty for a value without one. */
  tag: string;
  field: Field | null;
}

/** Texts that may be longer than this are written in several lines. */
const LONG_TEXT = 1000;

export function readField(schema: Schema, name = "", isRequired = true, around?: FieldDoc): Field {
  const unit = around?.unit ?? "";
  const doc = docOf([schema], { anchor: "", isRequired, unit, description: "" });
  const options = optionsOf(schema, doc);
  const canBeNull = isNullable(schema);
  const only = options.length === 1 && options[0]?.word === "" ? options[0].field : null;
  // A value or null, and nothing else to choose.
  const shape = options.length === 0 ? shapeOf(schema, doc) : (only?.shape ?? { is: "choice", options });
  const isCompound = ["group", "map", "list"].includes(shape.is) || (shape.is === "choice" && !isWords(shape.options));
  const isPart = isCompound && !isRequired && (canBeNull || !("default" in schema));
  return { name, label: labelOf(name, doc.unit), doc, isPart, shape };
}

function shapeOf(schema: Schema, doc: FieldDoc): Shape {
  const types = [schema["type"]].flat();
  if (types.includes("object")) {
    const properties = object(schema["properties"]);
    const names = Object.keys(properties);
    const required = list(schema["required"]);
    const any = schema["additionalProperties"];
    if (names.length > 0 || any === false) {
      const fields = names.map((name) => readField(object(properties[name]), name, required.includes(name)));
      return { is: "group", fields };
    }
    return typeof any === "object" && any !== null ? { is: "map", entry: readField(object(any)) } : { is: "any" };
  }
  if (types.includes("array")) {
    if (schema["items"] === undefined) return { is: "any" };
    const entry = readField(object(schema["items"]), "", true, doc);
    const [shortest, longest] = [Number(schema["minItems"] ?? 0), Number(schema["maxItems"] ?? Infinity)];
    return { is: "list", entry, shortest, longest };
  }
  if (types.includes("boolean")) return { is: "flag" };
  if (types.includes("number") || types.includes("integer")) return { is: "number" };
  if (types.includes("string")) return { is: "text", isLong: Number(schema["maxLength"] ?? 0) > LONG_TEXT };
  return { is: "any" };
}

/** Everything a value may be, choices within choices laid flat; empty when there is nothing to choose. */
function optionsOf(schema: Schema, doc: FieldDoc): Option[] {
  const about = typeof schema["description"] === "string" ? schema["description"] : "";
  if ("const" in schema) return [wordOption(schema["const"], about)];
  if ("enum" in schema) {
    const values = list(schema["enum"]);
    return values.map((value) => wordOption(value, values.length === 1 ? about : ""));
  }
  const branches = (["oneOf", "anyOf"] as const).flatMap((key) => list(schema[key]).map(object));
  return branches
    .filter((branch) => branch["type"] !== "null")
    .flatMap((branch) => {
      const inner = optionsOf(branch, doc);
      return inner.length > 0 ? inner : [fieldsOption(branch, doc)];
    });
}

function wordOption(value: unknown, about: string): Option {
  const label = typeof value === "string" ? humanise(value) : JSON.stringify(value);
  return { label, about, word: JSON.stringify(value), tag: "", field: null };
}

function fieldsOption(branch: Schema, doc: FieldDoc): Option {
  const properties = object(branch["properties"]);
  const [tag = "", ...more] = Object.keys(properties);
  const about = typeof branch["description"] === "string" ? branch["description"] : "";
  if (tag !== "" && more.length === 0 && list(branch["required"]).includes(tag)) {
    return { label: humanise(tag), about, word: "", tag, field: readField(object(properties[tag]), tag) };
  }
  const field = readField(branch, "", true, doc);
  return { label: PLAIN[field.shape.is], about, word: "", tag: "", field };
}

/** What an option without a name of its own is called. */
const PLAIN: Record<Shape["is"], string> = {
  number: "A number",
  text: "A text",
  flag: "Yes or no",
  group: "Field by field",
  map: "By names",
  list: "A list",
  choice: "A choice",
  any: "As text",
};

export function isWords(options: Option[]): boolean {
  return options.every(({ word }) => word !== "");
}

/** The option that a JSON text is; `keys` are the fields it has, if it is an object. */
export function optionOf(options: Option[], raw: string, keys: string[]): Option | undefined {
  const first = raw[0] ?? "";
  return (
    options.find(({ word }) => word !== "" && word === raw) ??
    options.find(({ tag }) => tag !== "" && first === "{" && keys.includes(tag)) ??
    options.find(({ tag, field }) => tag === "" && field && beginsAs(field.shape, first))
  );
}

/** Whether a JSON text is of the kind that a shape has fields for; `null` is nothing as yet. */
export function fits(shape: Shape, raw: string): boolean {
  if (raw === "null" || shape.is === "choice") return true;
  const isCompound = raw.startsWith("{") || raw.startsWith("[");
  // What was typed for a number may be anything, and is shown as it was typed.
  return shape.is === "number" || shape.is === "text" ? !isCompound : beginsAs(shape, raw[0] ?? "");
}

function beginsAs(shape: Shape, first: string): boolean {
  switch (shape.is) {
    case "group":
    case "map":
      return first === "{";
    case "list":
      return first === "[";
    case "number":
      return /[-\d]/.test(first);
    case "flag":
      return first === "t" || first === "f";
    case "text":
      return first === '"';
    case "choice":
    case "any":
      return first !== "";
  }
}

/**
 * What a field begins with when it is switched on: the parts that it must have, and no value that nobody gave.
 * Undefined when there is nothing but such values.
 */
export function scaffold(field: Field): unknown {
  const { shape, doc } = field;
  switch (shape.is) {
    case "group": {
      const parts = shape.fields.filter((inner) => inner.doc.isRequired).map((inner) => [inner.name, scaffold(inner)]);
      return Object.fromEntries(parts.filter(([, value]) => value !== undefined)) as object;
    }
    case "map":
      return {};
    case "list":
      return shape.shortest === 0 ? [] : undefined;
    case "number":
      // A range of one value, such as a version.
      return doc.range !== "" && Number.isFinite(Number(doc.range)) ? Number(doc.range) : undefined;
    case "choice":
    case "text":
    case "flag":
    case "any":
      return undefined;
  }
}

/** What an option begins with. */
export function scaffoldOf({ word, tag, field }: Option): unknown {
  if (word !== "") return JSON.parse(word) as unknown;
  const value = (field && scaffold(field)) ?? null;
  return tag === "" ? value : { [tag]: value };
}

function isNullable(schema: Schema): boolean {
  const branches = [...list(schema["oneOf"]), ...list(schema["anyOf"])].map(object);
  return [schema, ...branches].some(({ type }) => [type].flat().includes("null"));
}

/** `spacing_mm` as `Spacing`, when the unit is said beside it. */
function labelOf(name: string, unit: string): string {
  const suffix = `_${unit.toLowerCase().replaceAll("/", "_per_").replaceAll(/[ ·^]/g, "_")}`;
  return humanise(unit !== "" && unit !== "1" && name.endsWith(suffix) ? name.slice(0, -suffix.length) : name);
}

/** The first sentence of what a field means. */
export function gistOf({ description }: FieldDoc): string {
  return /^[\s\S]*?[.!?](?=\s+[A-Z`“]|\s*$)/.exec(description)?.[0] ?? description;
}

const NUMBER = /^-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?$/;
const LOOSE = /^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?$/;

/**
 * The JSON text of what was typed for a number. What is no number stays as a JSON string: the text then holds it, and
 * the server says what is wrong with it. A finished entry (`.5`, `+1`) is written as JSON has it.
 */
export function numberText(typed: string, isFinished: boolean): string {
  const trimmed = typed.trim();
  if (NUMBER.test(trimmed)) return trimmed;
  return isFinished && LOOSE.test(trimmed) && Number.isFinite(Number(trimmed))
    ? JSON.stringify(Number(trimmed))
    : JSON.stringify(typed);
}

/** What an input shows of a JSON text. */
export function shownText(raw: string): string {
  if (raw === "null") return "";
  return raw.startsWith('"') ? (JSON.parse(raw) as string) : raw;
}
