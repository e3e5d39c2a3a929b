/** @type {import("prettier").Config} */
export default {
  printWidth: 120,
  plugins: [import.meta.resolve("prettier-plugin-svelte")],
  overrides: [{ files: "*.svelte", options: { parser: "svelte" } }],
};
