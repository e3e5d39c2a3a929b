// Single sign-on in a real browser, by a real provider of OpenID Connect (npm's oidc-provider, certified
// by the OpenID Foundation) with keys and pages of its own.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Provider } from "oidc-provider";
import { close, isAccessible, lab, open, part, visit } from "./browser.mjs";
import { freePort } from "./lab.mjs";

const PEOPLE = {
  anna: { name: "Anna Weber", email: "anna@example.org", email_verified: true, groups: ["lab"] },
  eve: { name: "Eve", email: "eve@evil.example", email_verified: true, groups: [] },
};
const ASKED = { expected: /401|403/ };
let provider;
let issuer;

before(async () => {
  const [port, labPort] = [await freePort(), await freePort()];
  issuer = `http://127.0.0.1:${port}`;
  const address = `http://127.0.0.1:${labPort}`;
  const oidc = new Provider(issuer, {
    clients: [
      {
        client_id: "loadframe",
        client_secret: "a secret of tests",
        redirect_uris: [`${address}/v1/sign-in/provider`],
        id_token_signed_response_alg: "RS256",
      },
    ],
    claims: { openid: ["sub"], profile: ["name", "groups"], email: ["email", "email_verified"] },
    pkce: { required: () => true },
    cookies: { keys: ["of tests"] },
    findAccount: (_, id) => ({ accountId: id, claims: () => ({ sub: id, ...PEOPLE[id] }) }),
  });
  provider = createServer(oidc.callback()).listen(port, "127.0.0.1");
  await open({
    port: labPort,
    arguments: (folder) => {
      const [secret, settings] = [join(folder, "secret"), join(folder, "sign-on.json")];
      writeFileSync(secret, "a secret of tests");
      const asked = { name: "the university", issuer, client_id: "loadframe", client_secret_file: secret, address };
      const admit = [{ group: "lab", role: "member" }];
      writeFileSync(settings, JSON.stringify({ provider: asked, admit }));
      return ["--single-sign-on", settings];
    },
  });
  lab.createAdministrator("Ada", "a password for tests");
  // The server follows the command within a second.
  await new Promise((resolve) => setTimeout(resolve, 1500));
});

after(async () => {
  await close();
  provider?.closeAllConnections();
  provider?.close();
});

/** Goes to the provider and signs in there as somebody. */
async function signOn(page, name) {
  await part(page, "sign-on").click();
  await page.locator("input[name=login]").fill(name);
  await page.locator("input[name=password]").fill("any");
  await page.locator("button[type=submit]").click();
  // The provider asks whether the lab may know.
  await page.getByRole("button", { name: /continue/i }).click();
}

test("who fits a rule is signed in by the provider, and has an account from then on", async () => {
  const options = { ...ASKED, elsewhere: issuer };
  for (const round of [1, 2]) {
    await visit(
      "/",
      async (page) => {
        if (round === 1) {
          await part(page, "sign-on").waitFor();
          await isAccessible(page, "signing in with a provider");
        }
        await signOn(page, "anna");
        await part(page, "account").waitFor();
        assert.equal(await part(page, "account").innerText(), "Anna Weber");
        assert.equal(new URL(page.url()).origin, lab.url);
        assert.ok(!page.url().includes("code"), "the code leaves the address");
        const me = await page.evaluate(async () => (await fetch("/v1/me")).json());
        assert.equal(me.person.role, "member");
      },
      options,
    );
  }
});

test("who fits none is told so and stays outside", async () => {
  await visit(
    "/",
    async (page) => {
      await signOn(page, "eve");
      await part(page, "refused").waitFor();
      assert.match(await part(page, "refused").innerText(), /not invited/);
      await isAccessible(page, "refused");
      assert.equal(await page.evaluate(async () => (await fetch("/v1/me")).status), 401);
    },
    { ...ASKED, elsewhere: issuer },
  );
});
