// The editor in the page's own colours, in both lights.
import { HighlightStyle, syntaxHighlighting } from "@codemirror/language";
import type { Extension } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { tags } from "@lezer/highlight";

const theme = EditorView.theme({
  "&": {
    height: "var(--editor-height)",
    backgroundColor: "var(--surface)",
    color: "var(--ink)",
    fontSize: "13px",
  },
  "&.cm-focused": { outline: "2px solid var(--focus)", outlineOffset: "1px" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "20px", fontVariantLigatures: "none" },
  ".cm-content": { caretColor: "var(--ink)", padding: "10px 0" },
  ".cm-cursor, .cm-dropCursor": { borderLeftColor: "var(--ink)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": {
    backgroundColor: "color-mix(in oklab, var(--focus), transparent 70%)",
  },
  ".cm-activeLine": { backgroundColor: "color-mix(in oklab, var(--accent-soft), transparent 55%)" },
  ".cm-gutters": { backgroundColor: "var(--raised)", color: "var(--muted)", borderRight: "1px solid var(--line)" },
  ".cm-activeLineGutter": { backgroundColor: "var(--accent-soft)", color: "var(--ink)" },
  ".cm-foldPlaceholder": { backgroundColor: "var(--raised)", borderColor: "var(--line)", color: "var(--muted)" },
  ".cm-tooltip, .cm-panels": {
    backgroundColor: "var(--raised)",
    color: "var(--ink)",
    borderColor: "var(--line-strong)",
  },
  ".cm-tooltip": { maxWidth: "min(32rem, 90vw)", borderRadius: "6px" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--accent-ink)" },
  ".cm-completionDetail": { color: "inherit", fontStyle: "normal", opacity: "0.8" },
  ".cm-completionInfo": { padding: "0.4rem 0.6rem", fontFamily: "system-ui, sans-serif" },
  ".field-tooltip": { padding: "0.4rem 0.6rem", whiteSpace: "pre-line" },
  ".cm-diagnostic": { padding: "0.3rem 0.6rem", borderLeftColor: "var(--bad)" },
  ".cm-textfield, .cm-button": { color: "var(--ink)", background: "var(--surface)", borderColor: "var(--line-strong)" },
  ".cm-searchMatch": { backgroundColor: "var(--warn-soft)", outline: "1px solid var(--warn)" },
  // Below 16 px, phones zoom in on a focused field.
  "@media (max-width: 640px)": { "&": { fontSize: "16px" } },
});

const colours = HighlightStyle.define([
  { tag: tags.propertyName, color: "var(--series-1)" },
  { tag: tags.string, color: "var(--good)" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--warn)" },
  { tag: tags.invalid, color: "var(--bad)" },
]);

export const look: Extension = [theme, syntaxHighlighting(colours)];
