// JSON pointers (RFC 6901) and places in the text.
import type { JsonNode } from "./scan";

export function parsePointer(pointer: string): string[] {
  if (pointer === "") return [];
  return pointer
    .slice(1)
    .split("/")
    .map((part) => part.replaceAll("~1", "/").replaceAll("~0", "~"));
}

export function formatPointer(path: string[]): string {
  return path.map((part) => `/${part.replaceAll("~", "~0").replaceAll("/", "~1")}`).join("");
}

/** The node at a pointer or, when the field is not there (a missing one), its closest ancestor. */
export function findNode(root: JsonNode, pointer: string): JsonNode {
  let node = root;
  for (const part of parsePointer(pointer)) {
    const child = node.children.find((candidate) => candidate.name === part);
    if (!child) break;
    node = child;
  }
  return node;
}

/** Offsets at which lines begin. */
export function lineStarts(text: string): number[] {
  const starts = [0];
  for (let at = text.indexOf("\n"); at >= 0; at = text.indexOf("\n", at + 1)) starts.push(at + 1);
  return starts;
}

/** The line (from 0) an offset is on. */
export function lineAt(starts: number[], offset: number): number {
  let low = 0;
  let high = starts.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if ((starts[middle] ?? 0) <= offset) low = middle;
    else high = middle - 1;
  }
  return low;
}
