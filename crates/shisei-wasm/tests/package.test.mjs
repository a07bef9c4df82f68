// The package as users get it, in Node: SHISEI_PACKAGE is its folder, SHISEI the command line to compare with.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { test } from "node:test";

const root = new URL("../../../", import.meta.url);
const shisei = await import(pathToFileURL(join(process.env.SHISEI_PACKAGE, "node.js")));
const { sheet, orient, readRecording, ShapeError, DomainError, ConditionError, RecordingError, Table } = shisei;
const file = (name) => ({ name, bytes: readFileSync(new URL(`examples/${name}`, root)) });
const close = (found, expected, tolerance) => {
  assert.equal(found.length, expected.length);
  found.forEach((value, k) => assert.ok(Math.abs(value - expected[k]) <= tolerance * Math.max(1, Math.abs(expected[k])), `${value} for ${expected[k]}`));
};

shisei.setLanguage("en");

for (const example of JSON.parse(readFileSync(new URL("fixtures/functions/examples.json", root)))) {
  test(`the example of ${example.name}`, () => {
    const found = sheet[example.name](...example.args);
    if (example.expected === null) {
      assert.equal(typeof found, "string");
    } else if (typeof example.expected === "boolean") {
      assert.equal(found, example.expected);
    } else {
      const flat = found instanceof Table ? found.data : typeof found === "number" ? [found] : found;
      close([...flat], example.expected.flat(), example.tolerance);
    }
  });
}

test("attitudes have the bits of the command line", () => {
  const folder = mkdtempSync(join(tmpdir(), "shisei-js-"));
  try {
    for (const filter of ["shisei", "shisei-online", "mahony", "mahony-adaptive", "complementary", "gyro", "gyro-rk4"]) {
      const csv = join(folder, `${filter}.csv`);
      const command = ["orient", "examples/pelvis.csv", "--no-report", "--filter", filter, "-o", csv];
      execFileSync(process.env.SHISEI, command, { cwd: root, stdio: "ignore" });
      const [names, ...lines] = readFileSync(csv, "utf8").trim().split("\n").map((line) => line.split(","));
      const recording = readRecording(file("pelvis.csv"));
      const found = orient(recording, { filter });
      const columns = {
        time_s: recording.timeS,
        ...Object.fromEntries(["q_w", "q_x", "q_y", "q_z"].map((name, k) => [name, found.worldFromBody.column(k)])),
        ...Object.fromEntries(["yaw_rad", "pitch_rad", "roll_rad"].map((name, k) => [name, found.yprRad().column(k)])),
      };
      for (const [name, values] of Object.entries(columns)) {
        const at = names.indexOf(name);
        assert.deepEqual([...values], lines.map((cells) => Number(cells[at])).map((x) => (x === 0 ? 0 : x)), `${filter} ${name}`);
      }
    }
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test("the functions can be listed, and there are no others", () => {
  assert.ok(Object.keys(sheet).includes("Quat2Ypr") && Object.hasOwn(sheet, "Quat2Ypr"));
  assert.ok(!Object.hasOwn(sheet, "Quat2Yaw") && sheet.Quat2Yaw === undefined);
});

test("a recording says what it is", () => {
  const found = readRecording(file("pelvis.csv"));
  assert.equal(found.dialect, "mu-01");
  assert.equal(found.rateHz, 100);
  assert.deepEqual([found.timeS.length, found.accMS2.rows, found.gyroRadS.columns], [1671, 1671, 3]);
  assert.ok(found.assumptions.length > 0 && found.warnings.length === 0);
});

test("what a file does not say can be said", () => {
  const bytes = new TextEncoder().encode("t,a,b,c,d,e,f\n0,2,3,4,5,6,7\n1,2,3,4,5,6,7\n2,2,3,4,5,6,7\n");
  const columns = "time=t,gyr_x=a,gyr_y=b,gyr_z=c,acc_x=d,acc_y=e,acc_z=f";
  const found = readRecording({ name: "odd.csv", bytes }, { columns, units: "acc=g,gyr=deg/s,time=s", rateHz: 10 });
  close([...found.accMS2.row(0)], [5, 6, 7].map((x) => x * 9.80665), 1e-14);
  close([...found.gyroRadS.row(2)], [2, 3, 4].map((x) => (x * Math.PI) / 180), 1e-14);
  assert.throws(() => readRecording({ name: "odd.csv", bytes }, { units: "acc=furlong" }), RecordingError);
  const unnamed = { name: "odd.csv", bytes: new TextEncoder().encode("t,a,b\n1,2,3\n") };
  assert.throws(() => readRecording(unnamed), (error) => error.message.includes("with columns") && !error.message.includes("--"));
  assert.throws(() => readRecording({ name: "odd.csv", bytes }, { unit: "g" }), /no option unit/);
  assert.throws(() => readRecording({ name: "odd.csv" }), /name, bytes/);
});

const level = (rows, rate = 0) => ({
  gyroRadS: Array.from({ length: rows }, () => [0, 0, rate]),
  accMS2: Array.from({ length: rows }, () => [0, 0, 9.80665]),
});

test("rows, flat lists, typed arrays and tables are the same", () => {
  const { gyroRadS, accMS2 } = level(300, 0.01);
  const settings = { filter: "mahony", rest: null };
  const expected = orient({ gyroRadS, accMS2, rateHz: 100 }, settings).worldFromBody.data;
  const given = [
    { gyroRadS: gyroRadS.flat(), accMS2: accMS2.flat(), dtS: 0.01 },
    { gyroRadS: Float64Array.from(gyroRadS.flat()), accMS2: sheet.QuatsRotateVec3(Array(300).fill([1, 0, 0, 0]), [0, 0, 9.80665]), dtS: Array(300).fill(0.01) },
    { gyroRadS: gyroRadS.map((row) => Float64Array.from(row)), accMS2, timeS: gyroRadS.map((_, k) => k * 0.01), },
  ];
  given.slice(0, 2).forEach((readings) => assert.deepEqual(orient(readings, settings).worldFromBody.data, expected));
  close([...orient(given[2], settings).worldFromBody.data], [...expected], 1e-12);
});

test("one sample at a time has the bits of many", () => {
  const recording = readRecording(file("pelvis.csv"));
  const settings = { filter: "mahony", kp: 0.5, ki: 0.01, rest: [0, 300] };
  const whole = orient(recording, settings);
  const mahony = new shisei.Mahony({ start: whole.start, kp: 0.5, ki: 0.01 });
  for (let k = 0; k < recording.timeS.length; k += 1) {
    const gyro = recording.gyroRadS.row(k).map((rate, axis) => rate - whole.gyroBiasRadS[axis]);
    mahony.update(gyro, recording.accMS2.row(k), recording.dtS[k]);
  }
  assert.deepEqual(mahony.worldFromBody, whole.worldFromBody.row(whole.worldFromBody.rows - 1));
  const estimator = new shisei.Estimator();
  const states = [...recording.gyroRadS].map((gyro, k) => estimator.update(gyro, recording.accMS2.row(k), recording.dtS[k]));
  assert.ok(states.some((state) => state.rest) && states.at(-1).sigmaTiltRad < 0.05);
  assert.deepEqual(estimator.state, states.at(-1));
});

test("a table has the rows and columns that it has", () => {
  const table = new Table(Float64Array.of(1, 2, 3, 4, 5, 6), 2, 3);
  assert.deepEqual([[...table.row(1)], [...table.column(2)], [...table].length], [[4, 5, 6], [3, 6], 2]);
  for (const beyond of [() => table.column(3), () => table.column(-1), () => table.row(2), () => table.row(0.5), () => table.row()]) {
    assert.throws(beyond, DomainError);
  }
});

test("what an update gives is the caller's", () => {
  const mahony = new shisei.Mahony();
  const q = mahony.update([0, 0, 1], [0, 0, 9.8], 0.01);
  const kept = [...q];
  q[0] = -99;
  mahony.worldFromBody[1] = -99;
  assert.deepEqual([...mahony.worldFromBody], kept);
  const estimator = new shisei.Estimator();
  estimator.state.worldFromBody[0] = -99;
  assert.equal(estimator.state.worldFromBody[0], 1);
});

test("a filter can be freed, once or twice, and is then of no use", () => {
  for (const filter of [new shisei.Mahony(), new shisei.Estimator()]) {
    filter.free();
    filter.free();
    assert.throws(() => filter.update([0, 0, 0], [0, 0, 9.8], 0.01), /free\(\) was called/);
  }
  if (Symbol.dispose) {
    const filter = new shisei.Estimator();
    filter[Symbol.dispose]();
    assert.throws(() => filter.state, /free\(\) was called/);
  }
});

test("a calibration gives the bits of the command line", () => {
  const folder = mkdtempSync(join(tmpdir(), "shisei-js-"));
  try {
    const [path, learnt] = [join(folder, "cal.json"), join(folder, "learnt.json")];
    const calibration = {
      format: "shisei-calibration",
      version: 1,
      accelerometer: { bias_m_s2: [0.012345678901234567, -0.1 / 3, 1e-7 / 3], matrix: [[1 + 1e-3 / 3, 0, 0], [0, 0.99123, 0], [0, 0, 1]] },
      gyroscope: { bias_rad_s: [1e-3 / 7, 0, 0], matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] },
    };
    writeFileSync(path, JSON.stringify(calibration));
    const recording = readRecording(file("pelvis.csv"));
    const run = (more) => {
      const csv = join(folder, "out.csv");
      execFileSync(process.env.SHISEI, ["orient", "examples/pelvis.csv", "--no-report", "-o", csv, ...more], { cwd: root, stdio: "ignore" });
      return readFileSync(csv, "utf8").trim().split("\n").slice(1).map((line) => line.split(",").slice(1, 5).map(Number));
    };
    run(["--save-calibration", learnt]);
    const text = readFileSync(learnt, "utf8");
    for (const [filter, from, given] of [["shisei", path, calibration], ["mahony", path, JSON.stringify(calibration)], ["shisei", learnt, text], ["mahony", learnt, text]]) {
      const expected = run(["--filter", filter, "--calibration", from]);
      const found = orient(recording, { filter, calibration: given });
      assert.deepEqual([...found.worldFromBody].map((row) => [...row]), expected, `${filter} ${from}`);
    }
    const [plain, known] = [{}, { calibration }].map((settings) => new shisei.Estimator(settings).update([0, 0, 0.1], [0.3, 0.2, 9.8], 0.01));
    assert.notDeepEqual(plain.worldFromBody, known.worldFromBody);
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test("a start without a heading and another planet's gravity are said", () => {
  const recording = readRecording(file("pelvis.csv"));
  assert.match(orient(recording).warnings.join(), /forward -z/);
  assert.deepEqual(orient(recording, { forward: "z" }).warnings, []);
  assert.match(orient(recording, { forward: "z", gravityMS2: 8 }).warnings.join(), /^gravityMS2 8 is not found on the Earth/);
});

test("refusals have a kind and a sentence, in both languages", () => {
  const readings = { ...level(300), rateHz: 100 };
  const refusals = [
    [ShapeError, () => orient({ ...readings, gyroRadS: [[1, 2]] })],
    [ShapeError, () => orient({ ...readings, accMS2: readings.accMS2.slice(1) })],
    [ShapeError, () => orient({ ...readings, accMS2: readings.accMS2.map(() => ["0", "0", "9.8"]) })],
    [ShapeError, () => orient({ ...readings, accMS2: undefined })],
    [ShapeError, () => sheet.Quat2Ypr([1, 0, 0])],
    [ShapeError, () => sheet.Quat2Ypr()],
    [ShapeError, () => sheet.Quat2Ypr([1, 0, 0, 0], 1)],
    [DomainError, () => sheet.Quat2Ypr([0, 0, 0, 0])],
    [DomainError, () => orient(readings, { filter: "kalman" })],
    [DomainError, () => orient(readings, { forward: "up" })],
    [DomainError, () => orient(readings, { rest: [0, 1000] })],
    [DomainError, () => orient({ ...readings, rateHz: 0 })],
    [DomainError, () => orient({ ...level(3), timeS: [0, 1, 1] })],
    [DomainError, () => readRecording(file("pelvis.csv"), { rateHz: 0 })],
    [ShapeError, () => readRecording(file("pelvis.csv"), { rateHz: "100" })],
    [TypeError, () => readRecording(file("pelvis.csv"), { units: 1 })],
    [TypeError, () => readRecording(file("pelvis.csv"), null)],
    [ShapeError, () => readRecording({ name: "a.csv", bytes: new ArrayBuffer(3) })],
    [ShapeError, () => orient()],
    [ShapeError, () => orient({ gyroRadS: [], accMS2: [], rateHz: 100 })],
    [ShapeError, () => orient(readings, { filter: "mahony-adaptive", gain: { kpMax: "2" } })],
    [TypeError, () => orient({ ...readings, dtS: 0.01 })],
    [TypeError, () => orient(readings, { kp: 1 })],
    [TypeError, () => orient(readings, { gains: 1 })],
    [ConditionError, () => orient({ ...level(20), rateHz: 100 }, { filter: "mahony" })],
    [RecordingError, () => readRecording({ name: "a.csv", bytes: new TextEncoder().encode("a,b\n1,2\n") })],
    [DomainError, () => new shisei.Mahony({ kp: -1 })],
    [TypeError, () => new shisei.Mahony({ Kp: 5 })],
    [TypeError, () => orient(readings, [])],
    [ConditionError, () => orient(readings, { rest: [0, 5] })],
    [DomainError, () => orient({ ...level(3), dtS: NaN })],
    [DomainError, () => orient({ ...level(3), dtS: [0.01, 0, 0.01] })],
    [DomainError, () => orient({ ...level(3), timeS: [0, 1, Infinity] })],
    [TypeError, () => new shisei.Estimator({ gravity: 5 })],
    [DomainError, () => new shisei.Mahony({ start: [0, 0, 0, 0] })],
    [DomainError, () => new shisei.Estimator({ gravityMS2: 0 })],
    [DomainError, () => orient(readings, { forward: [0, 0, NaN] })],
    [DomainError, () => orient(readings, { calibration: {} })],
    [DomainError, () => new shisei.Estimator({ calibration: "{}" })],
    [TypeError, () => orient(readings, { calibration: 5 })],
    [DomainError, () => shisei.setLanguage("fr")],
    [ShapeError, () => new Table(new Float64Array(4), 4 / 3, 3)],
    [DomainError, () => new Table(new Float64Array(3), 1, 3).column(3)],
  ];
  for (const [Kind, refused] of refusals) {
    const sentences = ["en", "ja"].map((lang) => {
      shisei.setLanguage(lang);
      try {
        refused();
      } catch (error) {
        assert.ok(error instanceof Kind, `${refused}: ${error}`);
        return error.message;
      }
      return assert.fail(`${refused} was taken`);
    });
    assert.notEqual(sentences[0], sentences[1]);
    assert.match(sentences[1], /[ぁ-ん]/);
  }
  shisei.setLanguage("en");
});
