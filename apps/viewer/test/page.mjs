// What the browser checks share: a Chromium, counting, looking at pixels.
import { existsSync, mkdirSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";

export const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";

export class Checks {
  constructor(shots) {
    this.passed = 0;
    this.failed = 0;
    this.shots = shots;
    if (shots) mkdirSync(shots, { recursive: true });
  }

  check(name, ok, detail = "") {
    if (ok) this.passed++;
    else this.failed++;
    if (!ok) console.error(`FAILED ${name} ${detail}`);
  }

  /** True as soon as `question` answers so within the time. */
  async soon(name, question, within_ms = 15000) {
    const end = Date.now() + within_ms;
    let last;
    do {
      last = await question();
      if (last) break;
      await new Promise((done) => setTimeout(done, 60));
    } while (Date.now() < end);
    this.check(name, Boolean(last));
    return last;
  }

  async shot(page, name) {
    if (this.shots) await page.screenshot({ path: join(this.shots, `${name}.png`) });
  }

  finish() {
    console.log(`${this.passed} passed, ${this.failed} failed`);
    process.exit(this.failed ? 1 : 0);
  }
}

export async function launch() {
  if (!existsSync(executablePath)) {
    console.error(`no browser at ${executablePath}: install chromium or set CHROMIUM`);
    process.exit(2);
  }
  return chromium.launch({
    executablePath,
    args: [
      "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
      // WebGL without a graphics card
      "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--enable-precise-memory-info",
    ],
  });
}

/** A page of the viewer; whatever the console says, and every address it asks for beyond the hub, is a problem. */
export async function open(browser, url, query = "", options = {}) {
  const context = await browser.newContext({ viewport: { width: 1000, height: 640 }, locale: "en-US", ...options });
  const page = await context.newPage();
  page.problems = [];
  const origin = new URL(url).origin;
  page.on("console", (message) => {
    // a connection that is refused while the hub is away says so here
    if (["error", "warning"].includes(message.type()) && !/WebSocket connection|GPU stall|GL Driver/.test(message.text())) page.problems.push(message.text());
  });
  page.on("pageerror", (error) => page.problems.push(String(error)));
  page.on("request", (request) => { if (!request.url().startsWith(origin)) page.problems.push(`asked for ${request.url()}`); });
  const address = new URL(url);
  for (const [key, value] of new URLSearchParams(query)) address.searchParams.set(key, value);
  await page.goto(address.href);
  await page.waitForSelector("html[data-ready]", { timeout: 20000 });
  return page;
}

export const text = (page, selector) => page.locator(selector).first().textContent();

/** Positions and sources of all bodies, by name. */
export const bodies = (page) => page.evaluate(() => shisei.world.bodies.map((b) => ({ id: b.id, name: b.what.name, kind: b.what.kind, node: b.what.node, source: b.source, placed: b.placed, p: [...b.position_m], q: [...b.world_from_body] })));

/** Pixels of the 3-D picture that have about the colour of a CSS variable, counted right after it was drawn. */
export const inked = (page, variable) => page.evaluate((variable) => new Promise((done) => {
  requestAnimationFrame(() => {
    const stage = document.getElementById("stage");
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [stage.width, stage.height];
    const pen = copy.getContext("2d", { willReadFrequently: true });
    pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(variable);
    pen.fillRect(0, 0, 1, 1);
    const [r, g, b] = pen.getImageData(0, 0, 1, 1).data;
    pen.clearRect(0, 0, 1, 1);
    pen.drawImage(stage, 0, 0);
    const { data } = pen.getImageData(0, 0, copy.width, copy.height);
    let count = 0;
    for (let k = 0; k < data.length; k += 4) {
      // the same hue, shaded or not
      const scale = (data[k] * r + data[k + 1] * g + data[k + 2] * b) / (r * r + g * g + b * b);
      const off = Math.abs(data[k] - scale * r) + Math.abs(data[k + 1] - scale * g) + Math.abs(data[k + 2] - scale * b);
      if (data[k + 3] > 200 && scale > 0.6 && scale < 1.25 && off < 36) count++;
    }
    done(count);
  });
}), variable);

/** Processor time of the browser's graphics process so far, ms; NaN where the system does not tell. */
export function graphics_ms() {
  if (!existsSync("/proc/self/stat")) return NaN;
  const all = new Map();
  for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
    try {
      const stat = readFileSync(`/proc/${pid}/stat`, "utf8");
      // behind the name in brackets: parent, then times in ticks of 10 ms
      const fields = stat.slice(stat.lastIndexOf(")") + 2).split(" ");
      all.set(pid, { parent: fields[1], ms: 10 * (Number(fields[11]) + Number(fields[12])), command: readFileSync(`/proc/${pid}/cmdline`, "utf8") });
    } catch {
      // it has ended meanwhile
    }
  }
  const ours = (pid) => pid === String(process.pid) || (all.has(pid) && ours(all.get(pid).parent));
  let sum = 0;
  for (const [pid, { ms, command }] of all) if (command.includes("--type=gpu-process") && ours(pid)) sum += ms;
  return sum;
}
