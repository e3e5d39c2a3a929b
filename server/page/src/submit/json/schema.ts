// What a JSON Schema says about one field: meaning, unit, range, default. The server's schemas hold
// no references; choices (`oneOf`, `anyOf`) are read as all they may be.

import { showUnit } from "../../format/words";

export type Schema = Record<string, unknown>;

const INDEX = /^\d+$/;

export interface Option {
  value: string;
  description: string;
}

export interface FieldDoc {
  /** What the guide calls it: names joined by dots, `*` for entries and for what is named freely. */
  anchor: string;
  description: string;
  unit: string;
  type: string;
  range: string;
  /** JSON text of the default; empty when the field must be given. */
  default: string;
  isRequired: boolean;
  options: Option[];
  /** Fields an object may hold. */
  fields: string[];
}

/** What `root` says about the value at `path`, or null when it knows no such field. */
export function describeField(root: Schema, path: string[]): FieldDoc | null {
  const names: string[] = [];
  let anchor = "";
  let here: Schema[] = [root];
  let isRequired = false;
  let unit = "";
  let description = "";
  for (const part of path) {
    const parents = here.flatMap(expand);
    here = parents.flatMap((parent) => child(parent, part));
    names.push(parents.some((parent) => part in object(parent["properties"])) ? part : "*");
    if (here.length === 0) return null;
    isRequired = parents.some((parent) => list(parent["required"]).includes(part));
    // A list says unit and meaning once, for all of its entries.
    const isEntry = INDEX.test(part);
    // Entries that are plain values have no anchor of their own.
    if (!isEntry) anchor = names.join(".");
    unit = isEntry ? first(parents, "x-unit") || unit : "";
    description = isEntry ? first(parents, "description") || description : "";
  }
  return docOf(here, { anchor, isRequired, unit, description });
}

/** What schemas, one of which holds, say of their value; what they leave out is as its list has it. */
export function docOf(
  here: Schema[],
  around: Pick<FieldDoc, "anchor" | "isRequired" | "unit" | "description">,
): FieldDoc {
  const all = here.flatMap(expand);
  const given = here.find((schema) => "default" in schema) ?? all.find((schema) => "default" in schema);
  return {
    anchor: around.anchor,
    description: reflow(first(here, "description") || first(all, "description") || around.description),
    unit: first(all, "x-unit") || around.unit,
    type: typeOf(all),
    range: rangeOf(all) || all.map((schema) => rangeOfItems(schema)).find(Boolean) || "",
    default: given ? JSON.stringify(given["default"]) : "",
    isRequired: around.isRequired,
    options: all.flatMap(options),
    fields: [...new Set(all.flatMap((schema) => Object.keys(object(schema["properties"]))))],
  };
}

/** Longest default that is worth a line. */
const LONGEST_DEFAULT = 30;

/** Unit, range and default in one line. */
export function hintOf(doc: FieldDoc): string {
  const isShort = doc.default !== "" && doc.default !== '""' && doc.default.length <= LONGEST_DEFAULT;
  const fallback = doc.default === "null" ? "may be left out" : isShort ? `default ${doc.default}` : "";
  return [showUnit(doc.unit), doc.range, doc.isRequired ? "must be given" : fallback].filter(Boolean).join(" · ");
}

/** The schema itself and everything it chooses from. */
function expand(schema: Schema): Schema[] {
  const choices = ["oneOf", "anyOf", "allOf"].flatMap((key) => list(schema[key]) as Schema[]);
  return [schema, ...choices.flatMap(expand)];
}

function child(parent: Schema, part: string): Schema[] {
  const property = object(parent["properties"])[part];
  if (property !== undefined) return [object(property)];
  const any = parent["additionalProperties"];
  if (typeof any === "object") return [object(any)];
  if (!INDEX.test(part)) return [];
  const ordered = list(parent["prefixItems"])[Number(part)];
  const item = ordered ?? parent["items"];
  return item === undefined ? [] : [object(item)];
}

function rangeOf(all: Schema[]): string {
  const low = number(all, "minimum");
  const high = number(all, "maximum");
  const above = number(all, "exclusiveMinimum");
  const below = number(all, "exclusiveMaximum");
  if (low !== null && low === high) return String(low);
  if (low !== null && high !== null) return `${plain(low)} … ${plain(high)}`;
  const bounds = [
    low !== null ? `≥ ${plain(low)}` : above !== null ? `> ${plain(above)}` : "",
    high !== null ? `≤ ${plain(high)}` : below !== null ? `< ${plain(below)}` : "",
  ];
  return bounds.filter(Boolean).join(", ");
}

function rangeOfItems(schema: Schema): string {
  let items = object(schema["items"]);
  while (items["items"]) items = object(items["items"]);
  return rangeOf([items]);
}

function options(schema: Schema): Option[] {
  const description = reflow(first([schema], "description"));
  if ("const" in schema) return [{ value: JSON.stringify(schema["const"]), description }];
  const values = list(schema["enum"]);
  const sole = values.length === 1 ? description : "";
  return values.map((value) => ({ value: JSON.stringify(value), description: sole }));
}

function typeOf(all: Schema[]): string {
  const types = all.flatMap((schema) => (Array.isArray(schema["type"]) ? list(schema["type"]) : [schema["type"]]));
  const names = types.filter((type): type is string => typeof type === "string" && type !== "null");
  return [...new Set(names)].join(" or ");
}

function first(schemas: Schema[], key: string): string {
  const found = schemas.map((schema) => schema[key]).find((value) => typeof value === "string" && value !== "");
  return typeof found === "string" ? found : "";
}

/** Descriptions come with the line breaks of the source they were written in. */
function reflow(text: string): string {
  return text.replace(/(?<!\n)\n(?!\n)/g, " ");
}

function number(schemas: Schema[], key: string): number | null {
  const found = schemas.map((schema) => schema[key]).find((value) => typeof value === "number");
  return typeof found === "number" ? found : null;
}

function plain(value: number): string {
  const size = Math.abs(value);
  const power = value.toExponential().replace("e+", "e");
  const isFar = size !== 0 && (size >= 1e6 || size < 1e-3);
  return isFar && power.length < String(value).length ? power : String(value);
}

export function object(value: unknown): Schema {
  return typeof value === "object" && value !== null ? (value as Schema) : {};
}

export function list(value: unknown): unknown[] {
  return Array.isArray(value) ? value : [];
}
