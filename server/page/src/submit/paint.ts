// Colours for a line of JSON. No JSON token goes over a line's end, so each line stands alone.

export interface Token {
  text: string;
  kind: "key" | "text" | "number" | "word" | "other";
}

/** A longer line (a network on one line) is shown without colours, to keep typing quick. */
const LONGEST = 2000;
const TOKEN = /("(?:[^"\\]|\\.)*"?)(\s*:)?|(-?\d[\d.eE+-]*)|(true|false|null)/g;

export function paint(line: string): Token[] {
  if (line.length > LONGEST) return [{ text: line, kind: "other" }];
  const tokens: Token[] = [];
  let at = 0;
  for (const match of line.matchAll(TOKEN)) {
    if (match.index > at) tokens.push({ text: line.slice(at, match.index), kind: "other" });
    const [whole, quoted, colon, number] = match;
    if (quoted !== undefined) {
      tokens.push({ text: quoted, kind: colon === undefined ? "text" : "key" });
      if (colon !== undefined) tokens.push({ text: colon, kind: "other" });
    } else {
      tokens.push({ text: whole, kind: number === undefined ? "word" : "number" });
    }
    at = match.index + whole.length;
  }
  if (at < line.length) tokens.push({ text: line.slice(at), kind: "other" });
  return tokens;
}
