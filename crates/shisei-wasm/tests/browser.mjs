// The package in a headless Chromium, against itself in Node: SHISEI_PACKAGE is its folder, CHROMIUM names the browser
// (default /usr/bin/chromium). Prints "N passed, N failed"; exit 1 when one failed.
import { execFile } from "node:child_process";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { join, normalize } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { promisify } from "node:util";

const packageFolder = process.env.SHISEI_PACKAGE;
const examples = fileURLToPath(new URL("../../../examples/", import.meta.url));
const TYPES = { js: "text/javascript", wasm: "application/wasm", html: "text/html", csv: "text/csv" };

/** What both are asked; `shisei` is the package. */
async function answers(shisei, bytes) {
  const recording = shisei.readRecording({ name: "pelvis.csv", bytes });
  const bits = (numbers) => {
    let hash = 0xcbf29ce484222325n;
    for (const word of new BigUint64Array(Float64Array.from(numbers).buffer)) {
      hash = BigInt.asUintN(64, (hash ^ word) * 0x100000001b3n);
    }
    return hash.toString(16);
  };
  const found = {};
  for (const filter of ["shisei", "mahony", "complementary"]) {
    const orientation = shisei.orient(recording, { filter });
    found[filter] = bits(orientation.worldFromBody.data);
    found[`${filter}, angles`] = bits(orientation.yprRad().data);
  }
  found["a worksheet function"] = bits(shisei.sheet.Quat2Ypr([0.9, 0.1, -0.3, 0.3]));
  try {
    shisei.sheet.Quat2Ypr([0, 0, 0, 0]);
  } catch (error) {
    found["a refusal"] = `${error instanceof shisei.DomainError} ${error.message}`;
  }
  return found;
}

const page = `<!doctype html><meta charset="utf-8"><body><script type="module">
import * as shisei from "/package/browser.js";
const answers = ${answers};
const found = {};
try { shisei.version(); } catch (error) { found["before it is loaded"] = error.message; }
try {
  await shisei.init();
  shisei.setLanguage("en");
  const bytes = new Uint8Array(await (await fetch("/examples/pelvis.csv")).arrayBuffer());
  Object.assign(found, await answers(shisei, bytes));
} catch (error) { found.failed = String(error); }
document.body.textContent = JSON.stringify(found);
</script>`;

const server = createServer(async (request, response) => {
  const path = normalize(new URL(request.url, "http://localhost").pathname);
  try {
    const [, folder, ...rest] = path.split("/");
    const from = { package: packageFolder, examples }[folder];
    const body = from ? await readFile(join(from, ...rest)) : page;
    response.writeHead(200, { "content-type": from ? TYPES[path.split(".").pop()] : TYPES.html });
    response.end(body);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));

const shisei = await import(pathToFileURL(join(packageFolder, "node.js")));
shisei.setLanguage("en");
const expected = {
  "before it is loaded": "shisei is not loaded yet: call `await init()` first",
  ...await answers(shisei, await readFile(join(examples, "pelvis.csv"))),
};
const { stdout } = await promisify(execFile)(process.env.CHROMIUM ?? "/usr/bin/chromium", [
  "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=60000", "--dump-dom",
  `http://127.0.0.1:${server.address().port}/`,
], { timeout: 120_000 });
server.close();
const text = stdout.slice(stdout.lastIndexOf("<body>") + 6, stdout.indexOf("</body>")).trim();
const found = text.startsWith("{") ? JSON.parse(text) : { failed: text };

let failed = 0;
for (const [name, value] of Object.entries(expected)) {
  const same = found[name] === value;
  failed += same ? 0 : 1;
  console.log(`${same ? "ok    " : "FAILED"}  ${name}${same ? "" : `: ${found[name] ?? found.failed}, in Node ${value}`}`);
}
console.log(`${Object.keys(expected).length - failed} passed, ${failed} failed`);
process.exitCode = failed ? 1 : 0;
