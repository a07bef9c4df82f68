// The package in Node: ready as soon as it is imported.
import { readFileSync } from "node:fs";
import { initSync } from "./wasm/shisei.js";
import { loaded } from "./state.js";

initSync({ module: readFileSync(new URL("./wasm/shisei_bg.wasm", import.meta.url)) });
const { LC_ALL, LC_MESSAGES, LANG } = process.env;
loaded(LC_ALL || LC_MESSAGES || LANG || "");

/** For programs that also run in a browser; here nothing is left to do. */
export async function init() {}

export * from "./index.js";
