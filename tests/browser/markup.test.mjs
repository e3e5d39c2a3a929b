// Two hundred texts that are markup in every text field a person can write: nothing of them runs, and the
// content policy has nothing to stop.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { close, lab, open, part, visit } from "./browser.mjs";
import { PAYLOADS } from "./payloads.mjs";

const PASSWORD = "a password for tests";
const JOBS = 50;

before(() => open());
after(close);

/** Writes down what runs and what the policy stops, from the first line of every document. */
function watch() {
  globalThis.happened = [];
  globalThis.hit = () => globalThis.happened.push("it ran");
  document.addEventListener("securitypolicyviolation", (event) => {
    globalThis.happened.push(`${event.violatedDirective}: ${event.blockedURI}`);
  });
}

const isQuiet = async (page, where) => {
  assert.deepEqual(await page.evaluate(() => globalThis.happened), [], where);
};

/** Writes every payload into every field, by the page's own session; returns the ids of the jobs. */
function write({ payloads, jobs }) {
  return (async () => {
    const headers = { "Content-Type": "application/json" };
    const send = async (method, path, body, credentials = "same-origin") => {
      const answer = await fetch(path, {
        method,
        headers,
        credentials,
        body: body === undefined ? undefined : JSON.stringify(body),
      });
      if (!answer.ok) throw new Error(`${method} ${path}: ${await answer.text()}`);
      return answer.status === 204 ? null : answer.json();
    };
    const examples = await send("GET", "/v1/kinds/nonwoven_tensile/examples");
    const { job } = examples.items.find(({ name }) => name.endsWith("quick"));
    const share = payloads.length / jobs;
    const ids = [];
    for (let index = 0; index < jobs; index += 1) {
      const own = payloads.slice(index * share, (index + 1) * share);
      const tags = own.filter((text) => text.length <= 50);
      const made = await send("POST", "/v1/jobs", { ...job, name: own.join(" "), notes: payloads.join("\n"), tags });
      // Some are done before.
      await fetch(`/v1/jobs/${made.id}/cancel`, { method: "POST", headers });
      ids.push(made.id);
    }
    for (const [index, text] of payloads.entries()) {
      await send("POST", "/v1/projects", { name: text, visibility: "everyone" });
      // Names of groups and people differ in more than upper and lower case.
      await send("POST", "/v1/groups", { name: `${text} ${index}` });
      await send("POST", "/v1/tokens", { name: text, scope: "read" });
    }
    // Names of people are chosen by those who are invited.
    for (const [index, text] of payloads.slice(0, 100).entries()) {
      const { path } = await send("POST", "/v1/invitations", { role: "guest" });
      const secret = path.split("#")[1];
      const accepted = { secret, name: `${text} ${index}`, password: "a password for tests" };
      // Who accepts is signed in, and is somebody else.
      await send("POST", "/v1/invitations/accept", accepted, "omit");
    }
    return ids;
  })();
}

test("markup in a text stays a text wherever it is shown", async () => {
  assert.equal(new Set(PAYLOADS).size, 200);
  lab.createAdministrator("Ada", PASSWORD);
  await new Promise((resolve) => setTimeout(resolve, 1500));
  let ids = [];
  await visit(
    "/",
    async (page) => {
      await page.addInitScript(watch);
      await page.reload();
      // What would run is heard of.
      await page.evaluate(() => globalThis.hit());
      assert.deepEqual(await page.evaluate(() => globalThis.happened.splice(0)), ["it ran"]);
      await part(page, "sign-in-name").fill("Ada");
      await part(page, "sign-in-password").fill(PASSWORD);
      await part(page, "sign-in").click();
      await part(page, "account").waitFor();
      ids = await page.evaluate(write, { payloads: PAYLOADS, jobs: JOBS });

      // The list, and one page after the other; each is given time to draw what it was given.
      for (const place of ["/", "/submit", "/account", "/people", ...ids.slice(0, 10).map((id) => `/jobs/${id}`)]) {
        await page.goto(place);
        await page.locator("main h1").first().waitFor();
        await page.waitForTimeout(500);
        await isQuiet(page, place);
      }
    },
    { expected: /401|403|409/ },
  );
});
