// No imports in a circle, those of types included.
/** @type {import("dependency-cruiser").IConfiguration} */
export default {
  forbidden: [{ name: "no-circle", severity: "error", from: {}, to: { circular: true } }],
  options: {
    tsPreCompilationDeps: true,
    tsConfig: { fileName: "tsconfig.json" },
    doNotFollow: { path: "node_modules" },
    // `./liveJob.svelte` is `liveJob.svelte.ts`
    enhancedResolveOptions: { extensions: [".ts", ".js", ".svelte"] },
  },
};
