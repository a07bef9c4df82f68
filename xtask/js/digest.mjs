// node digest.mjs MODULE.wasm: prints the digests of all topics in their order, then that of all.
import { readFileSync } from "node:fs";

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), {});
const { topics, topic, all } = instance.exports;
const hex = (value) => BigInt.asUintN(64, value).toString(16).padStart(16, "0");
for (let i = 0; i < topics(); i += 1) {
  console.log(`${i} ${hex(topic(i))}`);
}
console.log(`all ${hex(all())}`);
