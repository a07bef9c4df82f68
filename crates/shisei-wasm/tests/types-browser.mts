// The types beside those of a browser; compiled, never run.
import { Estimator, init } from "shisei";

await init(new URL("shisei_bg.wasm", "https://example.org/"));
await init(new Request("shisei_bg.wasm"));
await init(await fetch("shisei_bg.wasm"));
await init(new ArrayBuffer(8));
await init(await WebAssembly.compile(new Uint8Array()));
{
  using live = new Estimator();
  live.state.rest;
}
