// Holds files against Khronos' glTF validator: node validate_gltf.mjs MODULES_FOLDER FILE.glb ...
// Errors, warnings and hints all count.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

const [modules, ...files] = process.argv.slice(2);
const { validateBytes } = createRequire(join(resolve(modules), "x.js"))("gltf-validator");
let bad = 0;
for (const file of files) {
  const { issues, info } = await validateBytes(new Uint8Array(readFileSync(file)));
  for (const issue of issues.messages) console.error(`${file}: ${issue.code} ${issue.message} ${issue.pointer ?? ""}`);
  bad += issues.numErrors + issues.numWarnings + issues.numHints;
  console.log(`${file}: ${info.animationCount} animations, ${info.totalVertexCount} vertices`);
}
process.exit(bad ? 1 : 0);
