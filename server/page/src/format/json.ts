// JSON as a person would write it: short lists on one line.

const WIDTH = 88;

export function formatJson(value: unknown, indent = "", isInList = false): string {
  if (typeof value !== "object" || value === null) return JSON.stringify(value) ?? "null";
  const inner = `${indent}  `;
  const isList = Array.isArray(value);
  const parts = isList
    ? value.map((item) => formatJson(item, inner, true))
    : Object.entries(value).map(([key, item]) => `${JSON.stringify(key)}: ${formatJson(item, inner)}`);
  if (parts.length === 0) return isList ? "[]" : "{}";
  const line = isList ? `[${parts.join(", ")}]` : `{${parts.join(", ")}}`;
  // Objects stay open, one field a line, unless they are short and inside a list.
  const isShort = !line.includes("\n") && indent.length + line.length <= WIDTH;
  if (isShort && (isList || isInList)) return line;
  const [open, close] = isList ? "[]" : "{}";
  return `${open}\n${parts.map((part) => inner + part).join(",\n")}\n${indent}${close}`;
}
