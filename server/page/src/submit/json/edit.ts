// Changes of single values in a text of JSON: what surrounds them keeps every byte.
import type { JsonNode } from "./scan";

/** What is put in place of a part of the text. */
export interface Change {
  from: number;
  to: number;
  insert: string;
}

export function applyChange(text: string, { from, to, insert }: Change): string {
  return text.slice(0, from) + insert + text.slice(to);
}

/**
 * Writes `raw`, a JSON text, at a path; what is missing on the way is made. New fields stand behind those that come
 * before them in `order`, the names that their object may have.
 */
export function setValue(
  text: string,
  root: JsonNode,
  path: string[],
  raw: string,
  order: (path: string[]) => string[] = () => [],
): Change {
  let node = root;
  let depth = 0;
  for (; depth < path.length; depth++) {
    const child = childOf(node, path[depth] ?? "");
    if (!child) break;
    node = child;
  }
  const name = path[depth];
  if (name === undefined) return { from: node.start, to: node.end, insert: indented(raw, indentAt(text, node.from)) };
  const value = path.slice(depth + 1).reduceRight((inner, key) => wrap(key, inner), raw);
  if (text[node.start] === "{") return insertField(text, node, name, value, order(path.slice(0, depth)));
  if (text[node.start] === "[") return insertEntry(text, node, Number(name), value);
  // Nothing that could hold a field stands there: `null`, as a rule.
  return { from: node.start, to: node.end, insert: indented(wrap(name, value), indentAt(text, node.from)) };
}

/** Takes a field or an entry out of the text; null when it is not there. */
export function removeValue(root: JsonNode, path: string[]): Change | null {
  let parent: JsonNode | undefined;
  let node: JsonNode | undefined = root;
  for (const name of path) [parent, node] = [node, node && childOf(node, name)];
  if (!node || !parent) return null;
  const index = parent.children.indexOf(node);
  const [before, after] = [parent.children[index - 1], parent.children[index + 1]];
  if (after) return { from: node.from, to: after.from, insert: "" };
  if (before) return { from: before.end, to: node.end, insert: "" };
  return { from: parent.start + 1, to: parent.end - 1, insert: "" };
}

/** The field or entry of a value by its name or index. */
export function childOf(node: JsonNode | undefined, name: string): JsonNode | undefined {
  // Entries stand at their index.
  const at = node?.children[Number(name)];
  return at?.name === name ? at : node?.children.find((child) => child.name === name);
}

function wrap(key: string, raw: string): string {
  return `{\n  ${JSON.stringify(key)}: ${indented(raw, "  ")}\n}`;
}

function insertField(text: string, node: JsonNode, name: string, value: string, order: string[]): Change {
  const place = order.indexOf(name);
  const isBefore = (child: JsonNode): boolean => {
    const other = order.indexOf(child.name);
    return place < 0 || other < 0 || other < place;
  };
  const before = node.children.findLast(isBefore);
  const first = node.children[0];
  if (!first) {
    const outer = indentAt(text, node.from);
    const member = `${JSON.stringify(name)}: ${indented(value, `${outer}  `)}`;
    return { from: node.start, to: node.end, insert: `{\n${outer}  ${member}\n${outer}}` };
  }
  // As the others stand: one a line, or side by side.
  const isOpen = text.slice(node.start, first.from).includes("\n");
  const indent = indentAt(text, first.from);
  const member = `${JSON.stringify(name)}: ${indented(value, indent)}`;
  const gap = isOpen ? `\n${indent}` : " ";
  if (!before) return { from: first.from, to: first.from, insert: `${member},${gap}` };
  return { from: before.end, to: before.end, insert: `,${gap}${member}` };
}

function insertEntry(text: string, node: JsonNode, index: number, value: string): Change {
  const last = node.children.at(-1);
  const missing = Array.from({ length: Math.max(0, index - node.children.length) }, () => "null");
  if (!last) {
    const indent = indentAt(text, node.from);
    return { from: node.start, to: node.end, insert: `[${[...missing, indented(value, indent)].join(", ")}]` };
  }
  const isOpen = text.slice(node.start, last.from).includes("\n") && startsItsLine(text, last.from);
  const indent = indentAt(text, last.from);
  const gap = isOpen ? `\n${indent}` : " ";
  const insert = [...missing, indented(value, indent)].map((entry) => `,${gap}${entry}`).join("");
  return { from: last.end, to: last.end, insert };
}

/** The white space that begins the line of an offset. */
function indentAt(text: string, offset: number): string {
  const line = text.lastIndexOf("\n", offset - 1) + 1;
  return /^[ \t]*/.exec(text.slice(line, offset))?.[0] ?? "";
}

function startsItsLine(text: string, offset: number): boolean {
  return text.slice(text.lastIndexOf("\n", offset - 1) + 1, offset).trim() === "";
}

function indented(raw: string, indent: string): string {
  return raw.replaceAll("\n", `\n${indent}`);
}
