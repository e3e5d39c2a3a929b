// A group's lab in a real browser: the first administrator, an invitation, a shared job, and a stranger
// with a link.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { close, fitsThePhone, isAccessible, lab, open, part, PHONE, picture, state, visit } from "./browser.mjs";

const PASSWORD = "a password for tests";
/** Before somebody is known the server says so, and browsers write that down. */
const ASKED = { expected: /401|403/ };

before(open);
after(close);

async function signIn(page, name) {
  await part(page, "sign-in-name").fill(name);
  await part(page, "sign-in-password").fill(PASSWORD);
  await part(page, "sign-in").click();
  await part(page, "account").waitFor();
}

/** Submits the quick example as the page would. */
function submitQuick(page) {
  return page.evaluate(async () => {
    const examples = await (await fetch("/v1/kinds/nonwoven_tensile/examples")).json();
    const { job } = examples.items.find(({ name }) => name.endsWith("quick"));
    const headers = { "Content-Type": "application/json" };
    const answer = await fetch("/v1/jobs", { method: "POST", headers, body: JSON.stringify(job) });
    return (await answer.json()).id;
  });
}

/** From an invitation to a curve that a stranger sees by a link, with all that is looked at here [ms]. */
const INVITED_UNTIL_SHARED = 60_000;

test("a group shares its jobs, and a stranger sees one by a link", async () => {
  lab.createAdministrator("Ada", PASSWORD);
  // The server follows the command within a second.
  await new Promise((resolve) => setTimeout(resolve, 1500));

  let invitation = "";
  await visit(
    "/",
    async (page) => {
      await part(page, "sign-in-name").fill("Ada");
      await part(page, "sign-in-password").fill("not the password");
      await part(page, "sign-in").click();
      await part(page, "sign-in-error").waitFor();
      await isAccessible(page, "signing in");
      await signIn(page, "Ada");
      await page.getByRole("link", { name: "People" }).click();
      await part(page, "group-name").fill("Paper");
      await part(page, "group-make").click();
      await page.getByRole("heading", { name: "Paper" }).waitFor();
      await part(page, "invite").click();
      invitation = await part(page, "invite-link").innerText();
      assert.match(invitation, /\/invitation#lfi_/);
      await page.getByText("invitation.made").waitFor({ state: "detached" });
      await isAccessible(page, "people");
      await picture(page, "people");
    },
    ASKED,
  );

  let link = "";
  const invited = performance.now();
  await visit(
    invitation.slice(lab.url.length),
    async (page) => {
      await isAccessible(page, "an invitation");
      await part(page, "invited-name").fill("Anna");
      await part(page, "invited-password").fill(PASSWORD);
      await part(page, "invited-again").fill(PASSWORD);
      await part(page, "accept").click();
      await part(page, "account").waitFor();
      assert.equal(await part(page, "account").innerText(), "Anna");
      assert.equal(await page.getByRole("link", { name: "People" }).count(), 0);
      // This server sends no e-mail, and offers none.
      await part(page, "account").click();
      await part(page, "webhook-make").waitFor();
      assert.equal(await part(page, "mail-make").count(), 0);

      const id = await submitQuick(page);
      await page.goto(`/jobs/${id}`);
      await state(page, "succeeded").waitFor();
      await part(page, "share").click();
      await part(page, "share-files").check();
      await part(page, "share-make").click();
      link = await part(page, "share-link").innerText();
      await isAccessible(page, "sharing");
      await picture(page, "sharing");
      await part(page, "share-close").click();

      await part(page, "account").click();
      await part(page, "token-name").fill("evaluation");
      await part(page, "token-make").click();
      assert.match(await part(page, "token-secret").innerText(), /^lf_/);
      await isAccessible(page, "the account");
      await picture(page, "account");
      await fitsThePhone(page, "the account");
      await part(page, "sign-out").click();
      await part(page, "sign-in-name").waitFor();
    },
    ASKED,
  );

  await visit(
    link.slice(lab.url.length),
    async (page) => {
      await state(page, "succeeded").waitFor();
      await part(page, "curve-over").waitFor();
      for (const shown of ["results", "quality", "show-snapshots"]) await part(page, shown).waitFor();
      const took = performance.now() - invited;
      assert.ok(took < INVITED_UNTIL_SHARED, `${took} ms`);
      assert.ok(!page.url().includes("#"), "the secret leaves the address");
      for (const hidden of ["share", "delete", "rename", "new-job"]) {
        assert.equal(await part(page, hidden).count(), 0, hidden);
      }
      await part(page, "run-facts").locator("summary").click();
      await page.getByRole("heading", { name: "Provenance" }).waitFor();
      await part(page, "show-snapshots").click();
      await part(page, "viewport").waitFor();
      await isAccessible(page, "a shared job");
      await fitsThePhone(page, "a shared job");
      await picture(page, "shared-job");
    },
    { ...ASKED, viewport: PHONE },
  );
});

test("a comparison is shared by a link, and a stranger sees its curves alone", async () => {
  let [link, outside] = ["", ""];
  await visit(
    "/",
    async (page) => {
      await signIn(page, "Ada");
      const jobs = [];
      for (let count = 0; count < 3; count += 1) jobs.push(await submitQuick(page));
      for (const id of jobs) {
        await page.goto(`/jobs/${id}`);
        await state(page, "succeeded").waitFor();
      }
      outside = jobs[2];
      await page.goto(`/compare?jobs=${jobs.slice(0, 2).join(",").replaceAll("-", "")}`);
      await part(page, "keep").click();
      await part(page, "keep-name").fill("Two strips");
      await part(page, "keep-make").click();
      await part(page, "share").click();
      await part(page, "share-make").click();
      link = await part(page, "share-link").innerText();
      await part(page, "share-close").click();
      // one finds it again
      await page.goto("/compare");
      await part(page, "kept-list").getByRole("link", { name: "Two strips" }).waitFor();
      await isAccessible(page, "kept comparisons");
      await picture(page, "kept-comparisons");
      await fitsThePhone(page, "kept comparisons");
    },
    ASKED,
  );
  await visit(
    link.slice(lab.url.length),
    async (page) => {
      await page.locator('[data-testid="compare"][data-jobs="2"]').waitFor();
      assert.ok(!page.url().includes("#"), "the secret leaves the address");
      for (const hidden of ["share", "keep", "keep-view", "forget", "new-job"]) {
        assert.equal(await part(page, hidden).count(), 0, hidden);
      }
      await isAccessible(page, "a shared comparison");
      await fitsThePhone(page, "a shared comparison");
      await picture(page, "shared-comparison");
      const status = await page.evaluate(async (id) => {
        const token = { Authorization: `Bearer ${sessionStorage.getItem("loadframe-link") ?? ""}` };
        return (await fetch(`/v1/jobs/${id}`, { headers: token })).status;
      }, outside);
      assert.ok(status === 404 || status === 401, `a job beside it answers ${status}`);
    },
    { ...ASKED, expected: /401|403|404/, viewport: PHONE },
  );
});

test("a deleted job is in the trash and comes back", async () => {
  await visit(
    "/",
    async (page) => {
      await signIn(page, "Ada");
      const id = await submitQuick(page);
      await page.goto(`/jobs/${id}`);
      await state(page, "succeeded").waitFor();
      await part(page, "delete").click();
      await part(page, "delete").click();
      await part(page, "trash-link").click();
      await part(page, "trash").waitFor();
      await isAccessible(page, "the trash");
      await picture(page, "trash");
      await fitsThePhone(page, "the trash");
      await part(page, "restore").first().click();
      await part(page, "trash-said").waitFor();
      await page.goto(`/jobs/${id}`);
      await state(page, "succeeded").waitFor();
    },
    ASKED,
  );
});

test("the list shows, sorts and filters by values, and its address keeps that", async () => {
  await visit(
    "/",
    async (page) => {
      await signIn(page, "Ada");
      await page.goto("/");
      await part(page, "values").locator("summary").click();
      await part(page, "value-pointer").selectOption("/spec/seed");
      await part(page, "value-show").click();
      await part(page, "value").first().waitFor();
      await part(page, "value-operand").fill("1");
      await part(page, "value-filter").click();
      await part(page, "condition").waitFor();
      await page.getByRole("button", { name: "Sort all by seed" }).click();
      await page.waitForFunction(() => new URLSearchParams(window.location.search).get("sort") === "/spec/seed");
      const query = new URL(page.url()).searchParams;
      assert.deepEqual([query.get("where"), query.get("show")], ["/spec/seed>=1", "/spec/seed"]);
      await page.reload();
      await part(page, "value").first().waitFor();
      await isAccessible(page, "a list with values");
      await picture(page, "list-values");
      await page.setViewportSize(PHONE);
      await fitsThePhone(page, "a list with values");
    },
    ASKED,
  );
});

test("what was done comes fifty lines at a time, each of them once", async () => {
  await visit(
    "/",
    async (page) => {
      await signIn(page, "Ada");
      await page.evaluate(async () => {
        const headers = { "Content-Type": "application/json" };
        for (let index = 0; index < 110; index += 1) {
          const body = JSON.stringify({ name: `token ${index}`, scope: "read" });
          const answer = await fetch("/v1/tokens", { method: "POST", headers, body });
          if (!answer.ok) throw new Error(await answer.text());
        }
      });
      await page.getByRole("link", { name: "People" }).click();
      const lines = part(page, "audit-line");
      await lines.nth(49).waitFor();
      // What loads by itself would do so now.
      await page.waitForTimeout(500);
      assert.equal(await lines.count(), 50);
      await part(page, "audit-more").click();
      await lines.nth(99).waitFor();
      await part(page, "audit-more").click();
      await part(page, "audit-more").waitFor({ state: "detached" });
      const all = await page.evaluate(async () => (await (await fetch("/v1/audit?limit=1000")).json()).items.length);
      assert.equal(await lines.count(), all);
    },
    ASKED,
  );
});
