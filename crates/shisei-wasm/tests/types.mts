// The types as an application in Node meets them, without a browser's; compiled, never run.
import { Estimator, Mahony, RecordingError, Table, init, orient, readRecording, setLanguage, sheet } from "shisei";

await init();
await init("/wasm/shisei_bg.wasm");
setLanguage("ja");
const recording = readRecording({ name: "pelvis.csv", bytes: new Uint8Array() }, { units: "acc=g", rateHz: 100 });
const rate: number = recording.rateHz;
const found = orient(recording, { filter: "mahony", kp: 0.5, rest: [0, 300], forward: "-z" });
const yaw: Float64Array = found.yprRad("body").column(0);
orient({ gyroRadS: [[0, 0, 0]], accMS2: Float64Array.of(0, 0, 9.8), rateHz: rate }, { gain: { kpMax: 1 } });
const table: Table = sheet.UpdateQuatsByMahony([1, 0, 0, 0], recording.gyroRadS, recording.accMS2, 0.01, 0.2, 0);
const [w] = new Mahony({ start: table.row(0) }).update([0, 0, 0], [0, 0, 9.8], 0.01);
const { sigmaTiltRad, rest } = new Estimator({ gravityMS2: 9.798 }).update([0, 0, 0], [0, 0, 9.8], 0.01);
const truth: boolean = sheet.IsFiniteQuat([w ?? 0, 0, 0, sigmaTiltRad]) && rest;
for (const row of table) row.at(0);
await init(new Uint8Array());
const live = new Estimator({ calibration: "{}" });
live.free();
live[Symbol.dispose]();
orient(recording, { calibration: { format: "shisei-calibration" } });

// @ts-expect-error there is no such filter
orient(recording, { filter: "kalman" });
// @ts-expect-error a function of four numbers, not of a text
sheet.Quat2Ypr("1, 0, 0, 0");
// @ts-expect-error a number is no place to load from
await init(5);
// @ts-expect-error bytes are missing
readRecording({ name: "pelvis.csv" });
export { RecordingError, truth, yaw };
