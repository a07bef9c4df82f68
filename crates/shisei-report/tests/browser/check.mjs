// Opens the demo reports in a real headless Chromium and uses them as a person would.
//
//   cargo run -p shisei-report --example demo -- DIR
//   npm ci && node check.mjs DIR [SCREENSHOT_DIR]
//
// CHROMIUM names the browser (default /usr/bin/chromium). Prints "N passed, N failed"; exit 1 when one failed,
// 2 when there is no browser.
import { existsSync, mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [dir, shots] = process.argv.slice(2);
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
if (!dir || !existsSync(executablePath)) {
  console.error(dir ? `no browser at ${executablePath}: install chromium or set CHROMIUM` : "usage: node check.mjs DIR [SCREENSHOT_DIR]");
  process.exit(2);
}
if (shots) mkdirSync(shots, { recursive: true });

let passed = 0;
let failed = 0;
const check = (name, ok, detail = "") => {
  if (ok) passed++;
  else failed++;
  if (!ok) console.error(`FAILED ${name} ${detail}`);
};

const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});

const open = async (name, options = {}) => {
  const context = await browser.newContext({ viewport: { width: 1366, height: 900 }, ...options });
  const page = await context.newPage();
  page.problems = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) page.problems.push(message.text()); });
  page.on("pageerror", (error) => page.problems.push(String(error)));
  page.on("request", (request) => { if (!/^(file|data):/.test(request.url())) page.problems.push(`asked for ${request.url()}`); });
  await page.goto(pathToFileURL(resolve(dir, name)).href);
  await page.waitForSelector("html[data-ready]", { timeout: 20000 });
  return page;
};

// Pixels of a plot that have about the colour of a series.
const inked = (page, plot, tone) => page.evaluate(([plot, tone]) => {
  const canvas = document.querySelector(`#plot${plot} canvas`);
  const copy = document.createElement("canvas");
  copy.width = canvas.width;
  copy.height = canvas.height;
  const probe = copy.getContext("2d", { willReadFrequently: true });
  probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(`--tone-${tone}`);
  probe.fillRect(0, 0, 1, 1);
  const [r, g, b] = probe.getImageData(0, 0, 1, 1).data;
  probe.clearRect(0, 0, 1, 1);
  probe.drawImage(canvas, 0, 0);
  const { data } = probe.getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) {
    if (Math.abs(data[k] - r) + Math.abs(data[k + 1] - g) + Math.abs(data[k + 2] - b) < 40 && data[k + 3] > 200) count++;
  }
  return count;
}, [plot, tone]);

const pose = (page) => page.getAttribute("#attitude", "data-pose");
const picture = (page) => page.evaluate(() => document.getElementById("attitude").toDataURL());
const range = (page, plot) => page.evaluate((k) => {
  const { min, max } = shisei.charts.list[k].u.scales.x;
  return [min, max];
}, plot);
const seek = (page, t) => page.$eval("#time", (slider, t) => {
  slider.value = String(t);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
}, t);
const value = (page, plot, k) => page.$eval(`#legend${plot} button:nth-child(${k + 1}) span`, (e) => Number(e.textContent.replace("−", "-").split(/[° ]/)[0]));

for (const lang of ["en", "ja"]) {
  for (const colorScheme of ["light", "dark"]) {
    const at = `${lang}/${colorScheme}`;
    const page = await open(`${lang}.html`, { colorScheme });
    check(`${at}: language`, (await page.getAttribute("html", "lang")) === lang);
    for (const plot of [0, 1, 2]) {
      for (const tone of ["x", "y", "z"]) {
        const count = await inked(page, plot, tone);
        check(`${at}: plot ${plot} draws ${tone}`, count > 100, `${count} pixels`);
      }
    }

    const strays = await page.$$eval(".u-over", (all) => all.flatMap((over) => {
      const area = over.getBoundingClientRect();
      return [...over.querySelectorAll(".u-cursor-pt:not(.u-off)")].filter((point) => {
        const { x, y, width, height } = point.getBoundingClientRect();
        return x + width / 2 < area.left - 1 || x + width / 2 > area.right + 1 || y + height / 2 < area.top + 1 || y + height / 2 > area.bottom - 1;
      });
    }).length);
    check(`${at}: the first values are marked on their lines`, strays === 0, strays);

    // scrubbing turns the box and shows the values there
    const [startPose, startPicture] = [await pose(page), await picture(page)];
    await seek(page, 5);
    check(`${at}: scrub turns the attitude`, (await pose(page)) !== startPose && (await picture(page)) !== startPicture);
    // the demo turns 0.7 rad to the left by then
    check(`${at}: scrub shows the yaw`, Math.abs((await value(page, 0, 0)) - (0.7 * 180) / Math.PI) < 0.01, await value(page, 0, 0));
    await seek(page, 1e9);
    check(`${at}: scrub stops at the end`, Number(await page.inputValue("#time")) < 31);

    // the pointer over any plot moves time everywhere
    await page.locator("#plot1").scrollIntoViewIfNeeded();
    const over = await page.locator("#plot1 .u-over").boundingBox();
    await page.mouse.move(over.x + over.width * 0.4, over.y + over.height / 2);
    const shown = Number(await page.inputValue("#time"));
    check(`${at}: pointer sets the time`, Math.abs(shown - 12) < 0.3, shown);
    const cursors = await page.$$eval(".u-cursor-x", (all) => all.map((e) => e.style.transform));
    check(`${at}: plots share the cursor`, new Set(cursors).size === 1 && !cursors[0].includes("-10"), cursors);

    // dragging zooms all plots, a double click shows everything
    await page.locator("#plot0").scrollIntoViewIfNeeded();
    const first = await page.locator("#plot0 .u-over").boundingBox();
    const middle = first.y + first.height / 2;
    await page.mouse.move(first.x + first.width * 0.2, middle);
    await page.mouse.down();
    await page.mouse.move(first.x + first.width * 0.5, middle, { steps: 5 });
    await page.mouse.up();
    await page.waitForTimeout(50);
    const zoomed = await range(page, 0);
    check(`${at}: drag zooms`, zoomed[0] > 4 && zoomed[1] < 17, zoomed);
    check(`${at}: zoom is shared`, String(zoomed) === String(await range(page, 2)), await range(page, 2));
    await page.mouse.dblclick(first.x + first.width * 0.5, middle);
    await page.waitForTimeout(50);
    check(`${at}: double click resets`, (await range(page, 2))[0] === 0, await range(page, 2));
    await page.click("#zoom-in");
    await page.click("#pan-right");
    await page.waitForTimeout(50);
    const panned = await range(page, 1);
    check(`${at}: buttons zoom and pan`, panned[1] - panned[0] < 16 && panned[0] > 0, panned);
    await page.click("#zoom-all");

    // without a mouse
    await seek(page, 3);
    await page.focus("#time");
    await page.keyboard.press("ArrowRight");
    check(`${at}: arrow key steps 0.1 s`, Math.abs(Number(await page.inputValue("#time")) - 3.1) < 1e-6);
    await page.keyboard.press("Shift+ArrowRight");
    check(`${at}: shift steps 1 s`, Math.abs(Number(await page.inputValue("#time")) - 4.1) < 1e-6);
    await page.keyboard.press(" ");
    await page.waitForTimeout(400);
    await page.keyboard.press(" ");
    const played = Number(await page.inputValue("#time"));
    check(`${at}: space plays and stops`, played > 4.2 && played < 6, played);
    await page.waitForTimeout(100);
    check(`${at}: it stays stopped`, Number(await page.inputValue("#time")) === played);
    await page.focus("#attitude");
    const beforeTurn = await picture(page);
    await page.keyboard.press("ArrowLeft");
    check(`${at}: arrow keys turn the view`, (await picture(page)) !== beforeTurn);

    const yaw = page.locator("#legend0 button").first();
    await yaw.focus();
    await page.keyboard.press("Enter");
    await page.waitForTimeout(50);
    const hidden = await inked(page, 0, "z");
    check(`${at}: a name hides its line`, (await yaw.getAttribute("aria-pressed")) === "false" && hidden < 50, hidden);
    await yaw.click();

    const unnamed = await page.$$eval("button, select, input, canvas#attitude", (all) =>
      all.filter((e) => !(e.textContent.trim() || e.getAttribute("aria-label") || e.labels?.length)).length);
    check(`${at}: every control has a name`, unnamed === 0, unnamed);
    check(`${at}: nothing in the console, nothing asked of the network`, page.problems.length === 0, page.problems);
    if (shots) await page.screenshot({ path: `${shots}/${lang}-${colorScheme}.png`, fullPage: true });
    await page.context().close();
  }

  const phone = await open(`${lang}.html`, { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true });
  const overflow = await phone.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  check(`${lang}: fits a phone`, overflow <= 0, overflow);
  check(`${lang}: draws on a phone`, (await inked(phone, 0, "z")) > 100);
  if (shots) await phone.screenshot({ path: `${shots}/${lang}-phone.png`, fullPage: true });
  await phone.context().close();

  const print = await open(`${lang}.html`, { colorScheme: "dark" });
  const pdf = await print.pdf({ format: "A4", printBackground: false, ...(shots && { path: `${shots}/${lang}.pdf` }) });
  check(`${lang}: prints`, pdf.length > 20000 && print.problems.length === 0, print.problems);
  await print.context().close();

  const hostile = await open(`${lang}-hostile.html`);
  const broken = await hostile.evaluate(() => [window.broken, document.images.length, document.title]);
  check(`${lang}: hostile names stay text`, broken[0] === undefined && broken[1] === 0 && broken[2].startsWith("</script>"), broken);
  check(`${lang}: hostile page still works`, (await inked(hostile, 0, "z")) > 100 && hostile.problems.length === 0, hostile.problems);
  await hostile.context().close();
}

await browser.close();
console.log(`${passed} passed, ${failed} failed`);
process.exit(failed ? 1 : 0);
