// What is looked for in the page, its mock server and the browser's tests: mistakes that the compiler does not see, and
// circles of imports.
import js from "@eslint/js";
import { createNodeResolver, importX } from "eslint-plugin-import-x";
import svelte from "eslint-plugin-svelte";
import globals from "globals";
import ts from "typescript-eslint";

/** For plain JavaScript that Node runs. */
export const scripts = [
  js.configs.recommended,
  { languageOptions: { globals: { ...globals.node, ...globals.browser } } },
];

export default ts.config(
  { ignores: ["dist", "src/api/wire.ts"] },
  scripts,
  ts.configs.recommendedTypeChecked,
  svelte.configs.recommended,
  {
    plugins: { "import-x": importX },
    settings: {
      // `./liveJob.svelte` is `liveJob.svelte.ts`
      "import-x/resolver-next": [createNodeResolver({ extensions: [".ts", ".js", ".mjs"] })],
      "import-x/extensions": [".ts", ".svelte"],
      "import-x/parsers": { "@typescript-eslint/parser": [".ts"], "svelte-eslint-parser": [".svelte"] },
    },
    languageOptions: {
      parserOptions: { projectService: true, extraFileExtensions: [".svelte"], parser: ts.parser },
    },
    rules: {
      eqeqeq: ["error", "always", { null: "ignore" }],
      "import-x/no-cycle": "error",
      "@typescript-eslint/consistent-type-imports": "error",
      "@typescript-eslint/switch-exhaustiveness-check": "error",
    },
  },
  {
    // Other components are `any` here; svelte-check knows their types.
    files: ["**/*.svelte"],
    rules: Object.fromEntries(
      ["argument", "assignment", "call", "member-access", "return"].map((what) => [
        `@typescript-eslint/no-unsafe-${what}`,
        "off",
      ]),
    ),
  },
  { files: ["**/*.js", "**/*.mjs"], extends: [ts.configs.disableTypeChecked] },
);
