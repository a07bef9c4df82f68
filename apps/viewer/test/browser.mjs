// The page in a headless Chromium against the stand-in for the hub, where everything can be brought about at will.
//
//   npm ci && npm run build && node test/browser.mjs [SCREENSHOT_DIR]
//
// CHROMIUM names the browser (default /usr/bin/chromium). Prints "N passed, N failed"; exit 1 when one failed.
import { FakeHub } from "./fake-hub.mjs";
import { bodies, Checks, graphics_ms, inked, launch, open, text } from "./page.mjs";

const checks = new Checks(process.argv[2]);
const { check } = { check: checks.check.bind(checks) };
const soon = checks.soon.bind(checks);
const browser = await launch();
const hub = new FakeHub({ bodies: 3, gap_s: 0 });
const url = await hub.listen();

{
  const page = await open(browser, url, "lang=en&theme=dark");
  await soon("it says live", async () => (await text(page, "#link b")) === "Live");
  await soon("bodies come", async () => (await bodies(page)).filter((b) => b.placed).length >= 20);
  const before = await bodies(page);
  const moved = (b, k) => Math.hypot(...b.p.map((v, axis) => v - before[k].p[axis])) > 0.01;
  await soon("bodies move", async () => (await bodies(page)).filter(moved).length >= 3);
  check("the list names them", (await page.locator("#bodies .row b").allTextContents()).join().startsWith("Tool 1,Tool 2,Tool 3,Alice"));

  // an occlusion turns the colour, and it comes back
  const amber = async () => inked(page, "--bridged");
  await page.keyboard.press("l");
  await soon("nothing is bridged at first", async () => (await amber()) < 12);
  hub.gap_s = hub.occlusion_s;
  await soon("an occlusion turns the colour", async () => (await amber()) > 60);
  await soon("the list says so", async () => (await page.locator("#bodies .row").first().textContent()).includes("bridged"));
  check("and shows another sign than for optical", (await page.locator("#bodies .row svg").first().innerHTML()).includes("dash"));
  await soon("what vanished is said", async () => (await page.locator("#bodies .row").nth(2).textContent()).includes("vanished"));
  await checks.shot(page, "en-dark-occluded");
  hub.gap_s = 0;
  await soon("and it comes back", async () => (await amber()) < 12 || hub.time() % 9 > 7.2);
  await page.keyboard.press("l");

  // choosing: by list, by key, in the picture
  await page.click("#bodies .row >> nth=1");
  check("a click in the list chooses", (await text(page, "#inspector h2")) === "Tool 2");
  await page.keyboard.press("n");
  check("a key chooses the next", (await text(page, "#inspector h2")) === "Tool 3");
  await page.keyboard.press("Escape");
  check("Escape chooses nothing", !(await page.locator("#inspector").isVisible()));
  hub.paused = true;
  await page.waitForTimeout(300);
  const place = await page.evaluate(() => shisei.where(shisei.world.bodies[0]));
  await page.mouse.click(place.x, place.y);
  check("a click in the picture chooses", (await page.locator("#inspector").isVisible()) && (await text(page, "#inspector h2")) === "Tool 1", JSON.stringify(place));
  hub.paused = false;
  await page.keyboard.press("Escape");
  await page.click("#bodies .row >> nth=0");
  await soon("the graph is drawn", () => page.evaluate(() => {
    const canvas = document.getElementById("graph");
    // a copy: the browser complains where one that is drawn on is read again and again
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const pen = copy.getContext("2d", { willReadFrequently: true });
    pen.drawImage(canvas, 0, 0);
    const { data } = pen.getImageData(0, 0, copy.width, copy.height);
    let count = 0;
    for (let k = 3; k < data.length; k += 4) if (data[k] > 200) count++;
    return count > 800;
  }));
  const shown = await page.evaluate(() => [document.getElementById("yaw").textContent, shisei.world.bodies[0].angles_deg[0]]);
  check("yaw is shown in degrees", /^−?\d+\.\d°$/.test(shown[0]), shown);

  // what the buttons send
  const asked = (type) => hub.requests.filter((request) => request.type === type);
  check("a body's attitude is not for setting", (await page.isDisabled("#align")) && (await page.isDisabled("#heading button")));
  await page.click("#bodies .row[title='Wrist']");
  await page.click("#align");
  await soon("align is sent", async () => asked("align").some((request) => request.body === 200));
  await page.fill("#heading input", "45");
  await page.click("#heading button");
  await soon("a heading is sent", async () => asked("heading").some((request) => request.body === 200 && request.deg === 45));
  check("of a sensor by itself no position is said", (await text(page, "#position")) === "unknown");
  await soon("the hub's note appears", async () => (await page.locator(".toast").allTextContents()).join().includes("Attitude set"));
  await page.click("#follow");
  check("follow is on", (await page.getAttribute("#follow", "aria-pressed")) === "true");
  await page.keyboard.press("f");
  check("a key ends it", (await page.getAttribute("#follow", "aria-pressed")) === "false");

  // recording
  await page.click("#record");
  await soon("recording starts", async () => (await page.getAttribute("#record", "data-state")) === "on" && (await text(page, "#record b")) === "Stop");
  check("the hub was asked once", asked("record").length === 1 && asked("record")[0].on === true);
  await soon("its time counts", async () => /0:0[1-9] · \d+ kB/.test(await text(page, "#record-time")));
  check("the title says so", (await page.title()).startsWith("●"));
  await checks.shot(page, "en-dark-recording");
  await page.keyboard.press("r");
  await soon("recording stops", async () => (await page.getAttribute("#record", "data-state")) === "off" && asked("record").at(-1).on === false);

  // status and names
  await page.keyboard.press("s");
  await soon("the status page has inputs and nodes", async () => (await text(page, "#status")).includes("/dev/ttyACM0") && (await text(page, "#status")).includes("3.42 V"));
  check("what is lost is counted once", (await text(page, "#v-loss")) === "Lost 3");
  check("a battery that is low is marked", (await page.locator("#status .low").allTextContents()).includes("3.42 V"));
  await page.click("#status .rename[data-node='Wrist']");
  await page.fill("#status td input", "手首 <b>");
  await page.waitForTimeout(1200);
  check("typing is not overwritten", (await page.inputValue("#status td input")) === "手首 <b>");
  await page.keyboard.press("Enter");
  await soon("a node is renamed", async () => (await page.locator("#bodies .row b").allTextContents()).includes("手首 <b>"));
  check("names stay text", (await page.locator("#bodies b b, #status b b").count()) === 0);
  await checks.shot(page, "en-dark-status");
  await page.keyboard.press("s");

  // keys, languages, themes
  await page.keyboard.press("?");
  check("? shows the keys", (await page.locator("#help kbd").count()) > 15);
  await checks.shot(page, "en-dark-help");
  await page.keyboard.press("Escape");
  check("Escape closes them", !(await page.locator("#help").isVisible()));
  hub.broadcast({ type: "note", level: "warning", en: "Battery of Node C is low", ja: "Node C の電池が残り少なくなっています" });
  await soon("a warning appears", async () => (await page.locator(".toast.warning p").allTextContents()).join() === "Battery of Node C is low");
  await page.click("#language");
  check("notes on the screen stay", (await page.locator(".toast.warning p").textContent()) === "Battery of Node C is low");
  check("Japanese", (await page.getAttribute("html", "lang")) === "ja" && (await text(page, "#record b")) === "記録" && (await text(page, "#bodies h2")) === "剛体");
  await page.keyboard.press("d");
  check("light", (await page.getAttribute("html", "data-theme")) === "light");
  await page.waitForTimeout(300);
  await checks.shot(page, "ja-light");
  await page.goto(url);
  await page.waitForSelector("html[data-ready]");
  check("both are remembered", (await page.getAttribute("html", "lang")) === "ja" && (await page.getAttribute("html", "data-theme")) === "light");
  const unnamed = await page.$$eval("button, input, canvas", (all) => all.filter((e) => !(e.textContent.trim() || e.getAttribute("aria-label") || e.title)).map((e) => e.outerHTML));
  check("every control has a name", unnamed.length === 0, unnamed);
  check("nothing in the console, nothing asked elsewhere", page.problems.length === 0, page.problems);
  await page.context().close();
}

{
  // silence, loss, return
  const page = await open(browser, url, "lang=en&theme=light");
  await soon("live again", async () => (await text(page, "#link b")) === "Live");
  hub.paused = true;
  await soon("silence is said", async () => (await page.locator("#sign").isVisible()) && (await text(page, "#link b")) === "No data");
  await soon("and nothing stands still silently", async () => (await bodies(page)).every((b) => b.source === 0));
  hub.paused = false;
  await soon("it goes away by itself", async () => !(await page.locator("#sign").isVisible()) && (await text(page, "#link b")) === "Live");
  const port = hub.server.address().port;
  await hub.close();
  await soon("a lost hub is said", async () => (await page.locator("#sign").isVisible()) && (await text(page, "#sign b")).includes("no longer true"));
  await soon("the picture turns grey", () => page.evaluate(() => document.body.classList.contains("stale")));
  check("recording cannot be pressed", await page.locator("#record").isDisabled());
  await checks.shot(page, "en-light-lost");
  const second = new FakeHub({ bodies: 20 });
  await second.listen(port);
  await soon("it connects by itself", async () => (await text(page, "#link b")) === "Live" && (await bodies(page)).length === 38);
  check("the sign is gone", !(await page.locator("#sign").isVisible()));

  // what no hub would send
  const hostile = ["", "{", "null", "[]", '{"type":"poses","time_s":1,"poses":[null,[1],{"length":1e9}],"markers":[[null,1,2]]}', '{"type":"note","level":"error","en":"<img src=x onerror=window.broken=1>","ja":""}',
    JSON.stringify({ type: "status", nodes: [{ name: "<script>window.broken=1</script>" }], inputs: [5, null, {}] }), '{"type":"hello","protocol":99,"may":["record","format-disk"]}', "x".repeat(300000)];
  for (const message of hostile) second.raw(message);
  await soon("another protocol is said", async () => (await text(page, "#sign b")).includes("99"));
  second.raw(JSON.stringify({ type: "hello", protocol: 1, version: "", lang: "en", demo: true, may: [] }));
  await soon("the page goes on", async () => !(await page.locator("#sign").isVisible()) && (await text(page, "#link b")) === "Live");
  check("markup of others stays text", (await page.evaluate(() => window.broken)) === undefined && (await page.locator(".toast img").count()) === 0);
  check("without the right there is no recording", await page.locator("#record").isDisabled());
  await checks.shot(page, "en-light-20");

  // 20 bodies and a skeleton: our own work on a frame, and what it leaves for the collector
  await page.setViewportSize({ width: 1280, height: 720 });
  await page.waitForTimeout(1000);
  const paced = async () => {
    await page.evaluate(() => shisei.pace.clear());
    const before_ms = graphics_ms();
    await page.waitForTimeout(4000);
    const read = await page.evaluate(() => ({ ...shisei.pace.read(), count: shisei.pace.frames() }));
    return { ...read, graphics: (graphics_ms() - before_ms) / read.count };
  };
  const pace = await paced();
  console.log(`20 bodies and a skeleton at 1280×720: ${pace.fps.toFixed(1)} frames/s drawn by software, ${pace.work_ms.toFixed(2)} ms of our own work a frame (60 frames/s leave 16.67 ms)`);
  check("a frame takes us less than a quarter of 16.67 ms", pace.work_ms < 4.2, pace.work_ms);
  second.paused = true;
  await page.waitForTimeout(800);
  const growth = await page.evaluate(() => new Promise((done) => {
    // a collection in between takes nothing back from the sum
    let [last, sum, frames] = [performance.memory.usedJSHeapSize, 0, 0];
    const next = () => {
      const now = performance.memory.usedJSHeapSize;
      sum += Math.max(0, now - last);
      last = now;
      if (++frames < 60) requestAnimationFrame(next);
      else done(sum / frames);
    };
    requestAnimationFrame(next);
  }));
  second.paused = false;
  await page.evaluate(() => shisei.blank());
  const blank = await paced();
  second.paused = true;
  console.log(`the graphics process computes ${pace.graphics.toFixed(1)} ms a frame, ${blank.graphics.toFixed(1)} ms where nothing is drawn (${blank.fps.toFixed(1)} frames/s)`);
  console.log(`memory taken by a frame without messages: ${(growth / 1024).toFixed(1)} kB`);
  // three.js takes about 15 kB for itself; ours is none
  check("a frame takes little memory", growth < 40 * 1024, growth);
  check("nothing in the console", page.problems.length === 0, page.problems);
  await page.context().close();
  second.paused = false;

  const phone = await open(browser, `http://127.0.0.1:${port}/`, "lang=ja&theme=light", { viewport: { width: 390, height: 844 }, deviceScaleFactor: 1, hasTouch: true });
  await soon("a phone shows bodies", async () => (await bodies(phone)).filter((b) => b.placed).length >= 20);
  await phone.tap("#show-bodies");
  await phone.tap("#bodies .row >> nth=0");
  check("a tap chooses", await phone.locator("#inspector").isVisible());
  const wide = await phone.evaluate(() => [...document.querySelectorAll("#bar, #inspector, #legend")].filter((e) => e.getBoundingClientRect().right > innerWidth + 0.5 || e.getBoundingClientRect().left < -0.5).length);
  check("everything fits a phone", wide === 0, wide);
  await phone.waitForTimeout(600);
  await checks.shot(phone, "ja-phone");
  check("nothing in the phone's console", phone.problems.length === 0, phone.problems);
  await phone.context().close();
  await second.close();
}

await browser.close();
checks.finish();
