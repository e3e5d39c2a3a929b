// Where in a job a place of the text is, by the editor's own tree: it bears text that is not yet valid JSON.
import { ensureSyntaxTree, syntaxTree } from "@codemirror/language";
import type { EditorState } from "@codemirror/state";
import type { SyntaxNode } from "@lezer/common";

/** Longest wait for the tree of a long text [ms]. */
const PATIENCE_MS = 50;

export interface Place {
  /** Keys and indices from the root to the value, or to the object whose field is being named. */
  path: string[];
  /** Whether the place is a field's name or where one may be begun. */
  isName: boolean;
  /** What stands there: a name with its quotes, a value, or nothing as yet. */
  from: number;
  to: number;
  /** Where the surrounding object begins, to know which fields it has. */
  object: SyntaxNode | null;
}

/** What the text means at `position`. */
export function placeAt(state: EditorState, position: number, side: -1 | 1 = -1): Place {
  const tree = ensureSyntaxTree(state, position, PATIENCE_MS) ?? syntaxTree(state);
  let node: SyntaxNode = tree.resolveInner(position, side);
  // An unfinished word is an error inside the value that it will be.
  const isWord = node.type.isError && node.from < node.to;
  const [from, to] = isWord || isToken(node) ? [node.from, node.to] : [position, position];
  // Behind its end a value is left; behind a brace or a comma one is in what it belongs to.
  if (/^[}\]]$/.test(node.name) && node.to <= position && node.parent?.parent) node = node.parent.parent;
  while ((node.type.isError || /^[{}[\],:]$/.test(node.name)) && node.parent) node = node.parent;
  const isName = node.name === "PropertyName" || node.name === "Object";
  const object = node.name === "Object" ? node : closest(node, "Object");
  if (node.name === "PropertyName")
    return { path: pathOf(state, node.parent?.parent ?? node), isName, from, to, object };
  return { path: pathOf(state, node), isName, from, to, object };
}

/** Keys and indices from the root to a node. */
export function pathOf(state: EditorState, node: SyntaxNode): string[] {
  const path: string[] = [];
  for (let here: SyntaxNode | null = node; here; here = here.parent) {
    if (here.name === "Property") path.unshift(nameOf(state, here));
    else if (here.parent?.name === "Array" && isValue(here)) path.unshift(String(indexOf(here)));
  }
  return path;
}

/** Names of the fields that an object has. */
export function namesIn(state: EditorState, object: SyntaxNode): string[] {
  return object.getChildren("Property").map((property) => nameOf(state, property));
}

function nameOf(state: EditorState, property: SyntaxNode): string {
  const name = property.getChild("PropertyName");
  return name ? unquote(state.sliceDoc(name.from, name.to)) : "";
}

function unquote(quoted: string): string {
  try {
    return JSON.parse(quoted) as string;
  } catch {
    return quoted.replaceAll('"', "");
  }
}

function indexOf(value: SyntaxNode): number {
  let index = 0;
  for (let before = value.prevSibling; before; before = before.prevSibling) if (isValue(before)) index += 1;
  return index;
}

const VALUES = ["Object", "Array", "String", "Number", "True", "False", "Null"];

function isValue(node: SyntaxNode): boolean {
  return VALUES.includes(node.name);
}

function isToken(node: SyntaxNode): boolean {
  return node.name === "PropertyName" || (isValue(node) && node.name !== "Object" && node.name !== "Array");
}

function closest(node: SyntaxNode, name: string): SyntaxNode | null {
  let here: SyntaxNode | null = node;
  while (here && here.name !== name) here = here.parent;
  return here;
}
