// The public names; `index.d.ts` says what they take and give.
import { DomainError, ShapeError, kindly, native, say } from "./state.js";
import { Table, finiteVector, number, quaternion, rate, rectangle, series, steps, table, vector } from "./table.js";

export { Table };
export { ConditionError, DomainError, RecordingError, ShapeError } from "./state.js";

export const GRAVITY_M_S2 = 9.80665;
const IDENTITY = [1, 0, 0, 0];

export const version = () => native().version();

export const language = () => native().language();

export function setLanguage(lang) {
  if (lang !== "en" && lang !== "ja") {
    throw new DomainError(say(`the language is ${String(lang)}; it must be "en" or "ja"`,
      `言語が ${String(lang)} です。"en" か "ja" にしてください`));
  }
  native().setJapanese(lang === "ja");
}

/** One function of the table. */
function worksheetFunction({ name, args }, index) {
  const called = (...given) => {
    if (given.length > args.length) {
      throw new ShapeError(say(`${name} takes ${args.length} arguments and was given ${given.length}`,
        `${name} の引数は ${args.length} 個までです (${given.length} 個指定されました)`));
    }
    const taken = args.map((arg, k) => {
      if (given[k] === undefined) {
        return undefined;
      }
      if (arg.number) {
        return number(given[k], arg.name);
      }
      const { data, rows, columns } = rectangle(given[k], arg.name, arg.columns);
      return [data, rows, columns];
    });
    const found = kindly((wasm) => wasm.call(index, taken));
    return Array.isArray(found) ? table(found) : found;
  };
  return Object.defineProperty(called, "name", { value: name });
}

let functions;

export const sheet = new Proxy({}, {
  get: (_, name) => all()[name],
  has: (_, name) => name in all(),
  ownKeys: () => Reflect.ownKeys(all()),
  getOwnPropertyDescriptor: (_, name) => Object.getOwnPropertyDescriptor(all(), name),
});

function all() {
  functions ??= Object.fromEntries(
    JSON.parse(native().functions()).map((entry, index) => [entry.name, worksheetFunction(entry, index)]),
  );
  return functions;
}

/** A recording, as `readRecording` gives it. */
export class Recording {
  constructor(parts) {
    Object.assign(this, parts, { accMS2: table(parts.accMS2), gyroRadS: table(parts.gyroRadS) });
  }
}

const SAID = ["units", "columns", "axes", "scale"];
const TEXTS = [...SAID, "sensor"];

export function readRecording(files, options = {}) {
  known(options, [...TEXTS, "rateHz", "skipBadRows"], "readRecording");
  const strangeText = TEXTS.find((what) => !["string", "undefined"].includes(typeof options[what]));
  if (strangeText !== undefined) {
    throw new TypeError(say(`${strangeText} must be a text`, `${strangeText} は文字列で指定してください`));
  }
  const list = Array.isArray(files) ? files : [files];
  const strange = list.some((file) => typeof file?.name !== "string" || !(file.bytes instanceof Uint8Array));
  if (list.length === 0 || strange) {
    throw new ShapeError(say("a file is given as { name, bytes }, its bytes as Uint8Array",
      "ファイルは { name, bytes } で、bytes は Uint8Array で指定してください"));
  }
  return kindly((wasm) => {
    const rateHz = options.rateHz === undefined ? undefined : rate(options.rateHz);
    const reading = new wasm.Reading(rateHz, options.sensor, options.skipBadRows === true);
    try {
      SAID.filter((what) => options[what] !== undefined).forEach((what) => reading.set(what, options[what]));
      return new Recording(wasm.readRecording(list.map(({ name }) => name), list.map(({ bytes }) => bytes), reading));
    } finally {
      reading.free();
    }
  });
}

/** Refuses what is no object of options, and options that there are not. */
function known(options, names, where) {
  if (typeof options !== "object" || options === null || Array.isArray(options)) {
    throw new TypeError(say(`${where}: options are given as an object`, `${where}：指定はオブジェクトで渡してください`));
  }
  const strange = Object.keys(options).find((name) => !names.includes(name));
  if (strange !== undefined) {
    throw new TypeError(say(`${where}: there is no option ${strange}; there are ${names.join(", ")}`,
      `${where}：${strange} という指定はありません。指定できるのは ${names.join("、")} です`));
  }
}

const GAIN = { kpMax: 2, kpMin: 0.05, upperStart: 10.3, upperEnd: 14.7, lowerStart: 9.3, lowerEnd: 4.9 };

/** Filters: the settings that they take, and their parameters in the module's order. */
const FILTERS = {
  shisei: [[], () => ({})],
  "shisei-online": [[], () => ({})],
  mahony: [["kp", "ki"], ({ kp = 0.2, ki = 0 }) => ({ kp, ki })],
  "mahony-adaptive": [["gain", "ki"], ({ gain = {}, ki = 0 }) => ({ ...GAIN, ...gain, ki })],
  complementary: [["alpha"], ({ alpha = 0.98 }) => ({ alpha })],
  gyro: [[], () => ({})],
  "gyro-rk4": [[], () => ({})],
};
const OF_FILTERS = ["kp", "ki", "gain", "alpha"];

/** Attitudes of a recording, and how sure they are. */
export class Orientation {
  constructor({ worldFromBody, ...parts }) {
    Object.assign(this, { worldFromBody: table(worldFromBody) }, parts);
  }

  yprRad(relative = "world") {
    if (!["world", "body", "none"].includes(relative)) {
      throw new DomainError(say(`relative is ${relative}; it must be "world", "body" or "none"`,
        `relative が ${relative} です。"world"、"body"、"none" のいずれかにしてください`));
    }
    return table(kindly((wasm) => wasm.yprRad(this.worldFromBody.data, this.start, relative)));
  }
}

export function orient(readings, settings = {}) {
  known(settings, ["filter", ...OF_FILTERS, "rest", "forward", "gravityMS2", "calibration"], "orient");
  const { filter = "shisei", rest = "auto", forward, gravityMS2 = GRAVITY_M_S2, calibration } = settings;
  if (!Object.hasOwn(FILTERS, filter)) {
    const names = Object.keys(FILTERS);
    throw new DomainError(say(`filter is ${String(filter)}; it must be one of ${names.join(", ")}`,
      `filter が ${String(filter)} です。${names.join("、")} のいずれかにしてください`));
  }
  const [takes, parameters] = FILTERS[filter];
  const idle = OF_FILTERS.find((name) => settings[name] !== undefined && !takes.includes(name));
  if (idle !== undefined) {
    throw new TypeError(say(`${idle} has no meaning for filter ${filter}; leave it out`,
      `${idle} は filter ${filter} では使えません。外してください`));
  }
  known(settings.gain ?? {}, Object.keys(GAIN), "gain");
  if (typeof readings !== "object" || readings === null) {
    throw new ShapeError(say("readings are given as a Recording or as { gyroRadS, accMS2, rateHz }",
      "計測値は Recording か { gyroRadS, accMS2, rateHz } で指定してください"));
  }
  const gyro = series(readings.gyroRadS, 3, "gyroRadS");
  const acc = series(readings.accMS2, 3, "accMS2");
  const step = readings instanceof Recording ? readings.dtS : steps(gyro.rows, readings);
  const given = Float64Array.from(Object.entries(parameters(settings)), ([name, value]) => number(value, name));
  const rows = restRows(rest, gyro.rows);
  return new Orientation(kindly((wasm) => wasm.orient(
    filter, given, gyro.data, acc.data, step, rest === "auto", rows, axis(forward), number(gravityMS2, "gravityMS2"),
    calibrationText(calibration),
  )));
}

/** The rows of the rest that is given; nothing for "auto" and null. */
function restRows(rest, rows) {
  if (rest === "auto" || rest === null) {
    return new Uint32Array();
  }
  const [start, end] = vector(rest, 2, "rest");
  if (!(Number.isInteger(start) && Number.isInteger(end) && start >= 0 && start < end && end <= rows)) {
    throw new DomainError(say(`rest is ${start}, ${end} and the recording has rows 0 to ${rows}`,
      `rest が ${start}, ${end} ですが、記録の行は 0 から ${rows} までです`));
  }
  return Uint32Array.of(start, end);
}

/** A sensor axis: "+x" … "-z", three numbers, or nothing. */
function axis(forward) {
  if (forward === undefined) {
    return new Float64Array();
  }
  if (typeof forward !== "string") {
    return finiteVector(forward, 3, "forward");
  }
  if (!/^[+-]?[xyz]$/.test(forward)) {
    throw new DomainError(say(`forward is ${forward}; it must be +x, -x, +y, -y, +z, -z or three numbers`,
      `forward が ${forward} です。+x、-x、+y、-y、+z、-z または 3 つの数値にしてください`));
  }
  return Float64Array.from("xyz", (letter) => (forward.endsWith(letter) ? (forward[0] === "-" ? -1 : 1) : 0));
}

/** The text of a calibration file, from itself or from the object that it holds. */
function calibrationText(calibration) {
  if (calibration === undefined || typeof calibration === "string") {
    return calibration;
  }
  if (typeof calibration !== "object" || calibration === null) {
    throw new TypeError(say("calibration must be the text of a calibration file, or the object that it holds",
      "calibration には、キャリブレーションファイルの文字列か、その内容のオブジェクトを指定してください"));
  }
  return JSON.stringify(calibration);
}

/** A filter of the module, until it is freed. */
function running(filter) {
  if (filter === undefined) {
    throw new Error(say("free() was called; make a new one", "free() を呼んだ後は使えません。新しく作ってください"));
  }
  return filter;
}

export class Mahony {
  #filter;
  #worldFromBody;

  constructor(settings = {}) {
    known(settings, ["start", "kp", "ki"], "Mahony");
    const { start = IDENTITY, kp = 0.2, ki = 0 } = settings;
    const q = quaternion(start, "start");
    this.#filter = kindly((wasm) => new wasm.MahonyFilter(q, number(kp, "kp"), number(ki, "ki")));
    this.#worldFromBody = sheet.NormalizeQuat(q);
  }

  update(gyroRadS, accMS2, dtS) {
    const [gyro, acc] = [vector(gyroRadS, 3, "gyroRadS"), vector(accMS2, 3, "accMS2")];
    this.#worldFromBody = kindly(() => running(this.#filter).update(gyro, acc, number(dtS, "dtS")));
    return this.worldFromBody;
  }

  get worldFromBody() {
    return this.#worldFromBody.slice();
  }

  get gyroBiasRadS() {
    return running(this.#filter).integralRadS().map((rate) => 0 - rate);
  }

  free() {
    this.#filter?.free();
    this.#filter = undefined;
  }
}

export class Estimator {
  #filter;

  constructor(settings = {}) {
    known(settings, ["gravityMS2", "calibration"], "Estimator");
    const { gravityMS2 = GRAVITY_M_S2, calibration } = settings;
    this.#filter = kindly((wasm) => (
      new wasm.EstimatorFilter(number(gravityMS2, "gravityMS2"), calibrationText(calibration))
    ));
  }

  update(gyroRadS, accMS2, dtS) {
    const [gyro, acc] = [vector(gyroRadS, 3, "gyroRadS"), vector(accMS2, 3, "accMS2")];
    return kindly(() => running(this.#filter).update(gyro, acc, number(dtS, "dtS")));
  }

  get state() {
    return running(this.#filter).state();
  }

  free() {
    this.#filter?.free();
    this.#filter = undefined;
  }
}

// `using live = new Estimator()`, where the language has it.
if (Symbol.dispose) {
  [Mahony, Estimator].forEach(({ prototype }) => { prototype[Symbol.dispose] = prototype.free; });
}
