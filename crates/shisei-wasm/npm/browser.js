// The package in a browser: `await init()` once, before anything else.
import load from "./wasm/shisei.js";
import { loaded } from "./state.js";

/** Loads the module; `source` is its address, a Response or its bytes where it is not beside this file. */
export async function init(source) {
  await load(source === undefined ? undefined : { module_or_path: source });
  loaded(globalThis.navigator?.language ?? "");
}

export * from "./index.js";
