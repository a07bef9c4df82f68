// Bundles the page into crates/shisei-hub/assets/viewer, from where the hub serves it.
//
//   node build.mjs           writes it
//   node build.mjs --check   fails when what is committed there is not what the sources make
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, "../../crates/shisei-hub/assets/viewer");
const MADE = "Generated from apps/viewer by build.mjs; do not edit.";

const bundle = async (entry, banner) => {
  const result = await build({
    entryPoints: [join(here, entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
    logLevel: "error",
    banner: { [entry.endsWith("css") ? "css" : "js"]: banner },
  });
  return result.outputFiles[0].text;
};

export const make = async () => ({
  "index.html": readFileSync(join(here, "page/index.html"), "utf8").replace("<!doctype html>", `<!doctype html>\n<!-- ${MADE} -->`),
  "icon.svg": readFileSync(join(here, "page/icon.svg"), "utf8"),
  "viewer.css": await bundle("page/viewer.css", `/* ${MADE} */`),
  "viewer.js": await bundle("src/main.ts", `// ${MADE} It holds three.js: see three.LICENSE.`),
  "three.LICENSE": readFileSync(join(here, "node_modules/three/LICENSE"), "utf8"),
});

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const files = await make();
  const stale = [];
  mkdirSync(out, { recursive: true });
  for (const [name, text] of Object.entries(files)) {
    let committed = "";
    try {
      committed = readFileSync(join(out, name), "utf8");
    } catch {
      // not there yet: stale
    }
    if (committed === text) continue;
    stale.push(name);
    if (!process.argv.includes("--check")) writeFileSync(join(out, name), text);
  }
  if (process.argv.includes("--check") && stale.length) {
    console.error(`crates/shisei-hub/assets/viewer is stale: ${stale.join(", ")}; run \`npm ci && npm run build\` in apps/viewer and commit`);
    process.exit(1);
  }
  console.log(stale.length ? `written: ${stale.join(", ")}` : "crates/shisei-hub/assets/viewer is up to date");
}
