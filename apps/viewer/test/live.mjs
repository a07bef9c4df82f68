// The page in a headless Chromium with a real hub: `shisei live --demo`.
//
//   cargo build -p shisei-cli && npm ci && node test/live.mjs PATH_OF_SHISEI [SCREENSHOT_DIR]
//
// Prints "N passed, N failed"; exit 1 when one failed.
import { spawn } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { bodies, Checks, inked, launch, open, text } from "./page.mjs";

const [given, shots] = process.argv.slice(2);
const program = given && resolve(given);
if (!program) {
  console.error("usage: node test/live.mjs PATH_OF_SHISEI [SCREENSHOT_DIR]");
  process.exit(2);
}
const checks = new Checks(shots);
const check = checks.check.bind(checks);
const soon = checks.soon.bind(checks);
const folder = mkdtempSync(join(tmpdir(), "shisei-live-"));

/** Starts a hub; its address is the first line it prints. */
const start = (port) => new Promise((done, fail) => {
  const child = spawn(program, ["live", "--demo", "--listen", `127.0.0.1:${port}`, "--for", "180"], { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
  let out = "";
  child.stdout.on("data", (data) => {
    out += data;
    const url = /http:\/\/\S+/.exec(out);
    if (url) done({ child, url: url[0] });
  });
  child.on("error", fail);
  child.on("exit", (code) => fail(new Error(`shisei live ended with ${code}`)));
});
const stop = ({ child }) => new Promise((done) => {
  child.removeAllListeners("exit");
  child.on("exit", done);
  child.kill("SIGTERM");
});

let hub = await start(0);
const browser = await launch();
try {
  const page = await open(browser, hub.url, "lang=en&theme=dark");
  await soon("it says live", async () => (await text(page, "#link b")) === "Live");
  await soon("bodies, a skeleton and a node come", async () => {
    const all = await bodies(page);
    return all.filter((b) => b.kind === "body").length >= 3 && all.some((b) => b.kind === "bone") && all.some((b) => b.kind === "node");
  });
  await soon("cameras see bodies", async () => (await bodies(page)).filter((b) => b.source === 1 && b.kind === "body").length >= 1);
  const before = new Map((await bodies(page)).map((b) => [b.id, b]));
  const moved = (b) => before.has(b.id) && Math.hypot(...b.p.map((v, axis) => v - before.get(b.id).p[axis])) > 0.005;
  await soon("bodies move", async () => (await bodies(page)).filter(moved).length >= 3);
  check("it is marked as a demonstration", await page.locator("#demo").isVisible());
  await page.waitForTimeout(900);
  await checks.shot(page, "live-en-dark");

  // an occlusion: the colour turns and comes back
  await page.keyboard.press("l");
  const amber = async () => inked(page, "--bridged");
  const bridged = async () => (await bodies(page)).filter((b) => b.source === 2 && b.kind === "body");
  await soon("an occlusion turns the colour", async () => (await bridged()).length > 0 && (await amber()) > 15, 60000);
  await checks.shot(page, "live-en-dark-occluded");
  await soon("the list says so", async () => (await page.locator('#bodies .row[data-source="2"]').allTextContents()).join().includes("bridged"), 60000);
  const [hidden] = await bridged();
  await soon("the body comes back", async () => !hidden || (await bodies(page)).find((b) => b.id === hidden.id)?.source === 1, 60000);
  await soon("and so does the colour", async () => (await amber()) < 15, 60000);
  await page.keyboard.press("l");

  // recording
  await page.click("#record");
  await soon("recording starts", async () => (await page.getAttribute("#record", "data-state")) === "on");
  await soon("it grows", async () => /\d+(\.\d+)? [kM]B/.test(await text(page, "#record-time")));
  await page.keyboard.press("n");
  await page.keyboard.press("s");
  await soon("the status page has nodes and inputs", async () => (await page.locator("#status tbody tr").count()) >= 2);
  await checks.shot(page, "live-en-dark-recording");
  await page.click("#record");
  await soon("recording stops", async () => (await page.getAttribute("#record", "data-state")) === "off");
  const files = readdirSync(folder).filter((name) => name.endsWith(".mcap") && statSync(join(folder, name)).size > 1000);
  check("a recording is there", files.length === 1, files);

  await page.keyboard.press("g");
  await page.keyboard.press("d");
  check("Japanese", (await page.getAttribute("html", "lang")) === "ja" && (await text(page, "#record b")) === "記録");
  await page.waitForTimeout(800);
  await checks.shot(page, "live-ja-light");
  await page.keyboard.press("s");

  await page.evaluate(() => shisei.pace.clear());
  await page.waitForTimeout(3000);
  const pace = await page.evaluate(() => shisei.pace.read());
  console.log(`the demonstration: ${pace.fps.toFixed(1)} frames/s drawn by software, ${pace.work_ms.toFixed(2)} ms of our own work a frame`);

  // a hub that is killed and started again
  const { port } = new URL(hub.url);
  await stop(hub);
  await soon("a lost hub is said", () => page.locator("#sign").isVisible());
  hub = await start(port);
  await soon("it comes back by itself", async () => (await text(page, "#link b")) === "受信中" && !(await page.locator("#sign").isVisible()));
  await soon("with its bodies", async () => (await bodies(page)).some((b) => b.source === 1));
  check("nothing in the console, nothing asked elsewhere", page.problems.length === 0, page.problems);
} finally {
  await browser.close();
  await stop(hub);
  rmSync(folder, { recursive: true, force: true });
}
checks.finish();
