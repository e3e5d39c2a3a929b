// E-mail in a real browser: an address is asked for, its link followed, and the account says so.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { close, fitsThePhone, isAccessible, lab, open, part, picture, visit } from "./browser.mjs";
import { freePort } from "./lab.mjs";

const PASSWORD = "a password for tests";
/** Before somebody is known the server says so, and browsers write that down. */
const ASKED = { expected: /401|403/ };
const port = await freePort();

/** A server of SMTP (RFC 5321) that keeps what it takes. */
const postbox = { taken: [] };
const server = createServer((socket) => {
  let [text, message] = ["", null];
  const say = (line) => socket.write(`${line}\r\n`);
  say("220 here ESMTP");
  socket.setEncoding("utf8").on("data", (data) => {
    text += data;
    for (let end = text.indexOf("\r\n"); end >= 0; end = text.indexOf("\r\n")) {
      const line = text.slice(0, end);
      text = text.slice(end + 2);
      if (message !== null && line !== ".") message.push(line);
      else if (message !== null) {
        // long lines are broken after "=" (RFC 2045)
        postbox.taken.push(message.join("\n").replaceAll("=\n", ""));
        message = null;
        say("250 taken");
      } else if (/^DATA/i.test(line)) {
        message = [];
        say("354 go on");
      } else say(/^QUIT/i.test(line) ? "221 bye" : "250 fine");
    }
  });
  socket.on("error", () => {});
});

/** The port under which the lab is known has to stand in its settings before it starts. */
const own = await freePort();

before(async () => {
  await new Promise((resolve) => server.listen(port, "127.0.0.1", resolve));
  await open({
    port: own,
    arguments: (folder) => {
      const file = join(folder, "mail.json");
      const settings = {
        server: `127.0.0.1:${port}`,
        security: "none",
        from: "Loadframe <lab@example.org>",
        address: `http://127.0.0.1:${own}`,
      };
      writeFileSync(file, JSON.stringify(settings));
      return ["--mail", file];
    },
  });
  lab.createAdministrator("Ada", PASSWORD);
  // The server follows the command within a second.
  await new Promise((resolve) => setTimeout(resolve, 1500));
});
after(async () => {
  await close();
  server.close();
});

/** The first e-mail, once it is there. */
async function firstMail() {
  for (;;) {
    if (postbox.taken.length > 0) return postbox.taken[0];
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

test("an address gets e-mail once its link was followed by whoever asked", { timeout: 120_000 }, async () => {
  await visit(
    "/account",
    async (page) => {
      await part(page, "sign-in-name").fill("Ada");
      await part(page, "sign-in-password").fill(PASSWORD);
      await part(page, "sign-in").click();
      await part(page, "mail-address").fill("ada@example.org");
      await part(page, "mail-make").click();
      await part(page, "mail-said").waitFor();
      assert.match(await part(page, "mails").innerText(), /waits for its link/);
      await isAccessible(page, "an address of e-mail");
      await fitsThePhone(page, "an address of e-mail");
      const mail = await firstMail();
      const [link] = /http:\/\/127\.0\.0\.1:\d+\/mail#\S+/.exec(mail);
      await page.goto(link);
      await part(page, "mail-verified").waitFor();
      await isAccessible(page, "a verified address");
      await page.goto("/account");
      await part(page, "mails").waitFor();
      assert.doesNotMatch(await part(page, "mails").innerText(), /waits for its link/);
      await picture(page, "mails");
    },
    ASKED,
  );
});
