// `npm run dev`: the page against sample answers (dev/mock.ts), or against a server that runs:
// `LOADFRAME=http://127.0.0.1:8400 npm run dev`.
import { fileURLToPath } from "node:url";
import { defineConfig, mergeConfig } from "vite";
import base from "../vite.config";
import { mock } from "./mock";

const target = process.env["LOADFRAME"];

export default mergeConfig(
  base,
  defineConfig({
    root: fileURLToPath(new URL("..", import.meta.url)),
    ...(target
      ? { server: { proxy: { "^/(v1|version|docs|guide|openapi.json)": { target, changeOrigin: true } } } }
      : { plugins: [mock()] }),
  }),
);
