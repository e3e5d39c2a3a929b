import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vitest/config";

// Names carry a hash of the content, so the server may let browsers keep assets for ever and two
// builds of the same sources are the same bytes.
export default defineConfig({
  plugins: [svelte({ configFile: false })],
  build: {
    target: "es2022",
    outDir: "dist",
    emptyOutDir: true,
    assetsDir: "assets",
    // Otherwise the icon, which HTML and a component name, is in the script or not, as chance has it.
    assetsInlineLimit: 0,
    modulePreload: false,
    // Names whose work is in the page.
    license: { fileName: "licenses.md" },
    // The largest parts by far, and those that hardly ever change.
    rolldownOptions: {
      output: {
        advancedChunks: {
          groups: [
            { name: "three", test: /node_modules\/three\// },
            {
              name: "codemirror",
              test: /node_modules\/(codemirror|@codemirror|@lezer|@marijn|crelt|style-mod|w3c-keyname)\//,
            },
          ],
        },
      },
    },
  },
  // no test measures time: on a busy machine each may take a while
  test: { include: ["src/**/*.test.ts"], testTimeout: 120_000 },
});
