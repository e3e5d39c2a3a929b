// A lab to look at: `loadframe lab` on a free port, with a data folder of its own.
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, openSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

const BINARY = process.env.LOADFRAME_BIN ?? "../../target/release/loadframe";
/** Longest start; only a lab that hangs reaches it. */
const PATIENCE_MS = 60_000;

export async function freePort() {
  const server = createServer().listen(0, "127.0.0.1");
  await new Promise((resolve) => server.once("listening", resolve));
  const { port } = server.address();
  await new Promise((resolve) => server.close(resolve));
  return port;
}

/** Starts a lab and waits until it is ready; with `arguments` that may need its folder. */
export async function startLab({ port = null, arguments: more = () => [] } = {}) {
  const folder = mkdtempSync(join(tmpdir(), "loadframe-browser-"));
  const address = `127.0.0.1:${port ?? (await freePort())}`;
  const log = openSync(join(folder, "log"), "a");
  const lab = spawn(BINARY, ["lab", "--listen", address, "--data", join(folder, "data"), ...more(folder)], {
    stdio: ["ignore", log, log],
  });
  const url = `http://${address}`;
  const ended = new Promise((resolve) => lab.once("exit", resolve));
  const begin = Date.now();
  for (;;) {
    const answer = await fetch(`${url}/readyz`).catch(() => null);
    if (answer?.ok) break;
    if (lab.exitCode !== null || Date.now() - begin > PATIENCE_MS) {
      lab.kill("SIGKILL");
      throw new Error(`the lab did not start: ${readFileSync(join(folder, "log"), "utf8")}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return {
    url,
    /** Makes the lab a group's. */
    createAdministrator(name, password) {
      const file = join(folder, "password");
      writeFileSync(file, password);
      const data = ["--data", join(folder, "data"), "--password-file", file];
      const made = spawnSync(BINARY, ["people", "create-admin", name, ...data], { encoding: "utf8" });
      if (made.status !== 0) throw new Error(made.stderr);
    },
    async stop() {
      lab.kill("SIGTERM");
      await ended;
      rmSync(folder, { recursive: true, force: true });
    },
  };
}
