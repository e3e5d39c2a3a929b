// Takes the picture that README and guide show: the page of the demo's job, finished.
//   node picture.mjs        writes server/guide/pictures/lab.png
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { dirname } from "node:path";
import { close, open, part, state, visit } from "./browser.mjs";

const PATH = "../../server/guide/pictures/lab.png";
const EXAMPLE = "../../api/examples/nonwoven_tensile.json";

await open();
try {
  mkdirSync(dirname(PATH), { recursive: true });
  await visit(
    "/",
    async (page) => {
      const answer = await page.request.post("/v1/jobs", { data: JSON.parse(readFileSync(EXAMPLE, "utf8")) });
      const { id } = await answer.json();
      await page.goto(`/jobs/${id}`);
      await state(page, "succeeded").waitFor({ timeout: 600_000 });
      await page.waitForFunction(() => Number(document.querySelector("[data-testid=curve]")?.dataset.points) > 100);
      await part(page, "results").waitFor();
      await page.mouse.move(0, 0);
      await page.screenshot({ path: PATH });
    },
    { viewport: { width: 1200, height: 1040 } },
  );
} finally {
  await close();
}
execFileSync("ls", ["-l", PATH], { stdio: "inherit" });
