// Types and documentation of the package. Angles in rad, rates in rad/s, accelerations in m/s² (what an accelerometer
// reads: at rest upwards), times in s. Quaternions are w, x, y, z and turn sensor axes into world axes (z up).
import type { Sheet } from "./sheet.js";

/** Numbers row after row. */
export class Table implements Iterable<Float64Array> {
  /** Throws {@link ShapeError} unless there are rows × columns numbers. */
  constructor(data: Float64Array, rows: number, columns: number);
  readonly data: Float64Array;
  readonly rows: number;
  readonly columns: number;
  /** A row from 0, sharing the numbers. Throws {@link DomainError} where there is none. */
  row(k: number): Float64Array;
  /** A column from 0, copied. Throws {@link DomainError} where there is none. */
  column(k: number): Float64Array;
  [Symbol.iterator](): Iterator<Float64Array>;
}

/** Numbers in one list. */
export type Numbers = readonly number[] | Float64Array | Float32Array;
/** One sample a row: a table, a list of rows, or the numbers of all rows in one list. */
export type Rows = Table | readonly Numbers[] | Numbers;

declare global {
  interface SymbolConstructor {
    readonly dispose: unique symbol;
  }
}

/** What a global class makes; nothing where the surroundings do not have it, as Node without a browser's types. */
type Made<Name extends string> = typeof globalThis extends { [N in Name]: new (...given: any) => infer Instance } ? Instance : never;
type CompiledModule = typeof globalThis extends { WebAssembly: { Module: new (...given: any) => infer Module } } ? Module : never;
/** Where `shisei_bg.wasm` is, or what is in it. */
export type Source = string | ArrayBuffer | ArrayBufferView | Made<"URL"> | Made<"Request"> | Made<"Response"> | CompiledModule;

/** Loads the module: `await init()` once before anything else. In Node it is loaded already. `source` is the address of
 * `shisei_bg.wasm`, a Response, or its bytes, where it is not beside the package's other files. */
export function init(source?: Source): Promise<void>;

/** The version of shisei, one for all doors. */
export function version(): string;
/** The language of messages. At first it is that of the browser or of the environment. */
export function language(): "en" | "ja";
export function setLanguage(lang: "en" | "ja"): void;

/** An array has the wrong shape, or lengths differ (`#VALUE!` in a sheet). */
export class ShapeError extends Error {}
/** A value is out of range, zero where it may not be, or not finite (`#NUM!`). */
export class DomainError extends Error {}
/** The data do not meet a condition: not at rest, a face missing (`#N/A`). */
export class ConditionError extends Error {}
/** A file is not a recording that can be read. */
export class RecordingError extends Error {}

/** The worksheet functions under their worksheet names: `sheet.UpdateQuatsByMahony(…)`. A function whose
 * result is one row gives a Float64Array, one whose result is a series a {@link Table}, of one row too. */
export const sheet: Sheet;

/** 9.80665 m/s². */
export const GRAVITY_M_S2: number;

/** A file: its name (its ending may say what it is) and its bytes. A Blob gives them as
 * `new Uint8Array(await blob.arrayBuffer())`. */
export interface File {
  name: string;
  bytes: Uint8Array;
}

/** What the reader would guess, each as the command line takes it (`--units`, `--columns`, …). */
export interface ReadingOptions {
  /** `acc=g,gyr=deg/s`. */
  units?: string;
  /** `acc_x=Ax,acc_y=Ay,…`, or a role for every column. */
  columns?: string;
  /** `x,-y,-z`: axes of the result in terms of the sensor's. */
  axes?: string;
  /** `acc=16384,gyr=131`: counts per g and per deg/s. */
  scale?: string;
  /** Sampling rate, Hz; the stamps are then left aside. */
  rateHz?: number;
  /** Which sensor, where the file has several: part of its name. */
  sensor?: string;
  /** Leave out rows that cannot be read instead of refusing the file. */
  skipBadRows?: boolean;
}

/** A recording in SI units and sensor axes. */
export class Recording {
  private constructor();
  /** N stamps, s. */
  readonly timeS: Float64Array;
  /** N steps, s: the time since the sample before. */
  readonly dtS: Float64Array;
  /** N×3, m/s². */
  readonly accMS2: Table;
  /** N×3, rad/s. */
  readonly gyroRadS: Table;
  /** N, °C; where there is one. */
  readonly tempC?: Float64Array;
  /** What kind of file it is. */
  readonly dialect: string;
  readonly rateHz: number;
  readonly durationS: number;
  /** What had to be assumed, a sentence each. */
  readonly assumptions: string[];
  /** What to know before trusting it, a sentence each. */
  readonly warnings: string[];
}

/** A recording of one file, or of two that belong together (accelerometer and gyroscope). Every kind of file that the
 * command line reads but Parquet and MCAP. Throws {@link RecordingError}. */
export function readRecording(files: File | readonly File[], options?: ReadingOptions): Recording;

/** Readings in memory: N×3 and N×3, and one of `rateHz`, `timeS` (N) and `dtS` (one number, or N). */
export interface Readings {
  gyroRadS: Rows;
  accMS2: Rows;
  rateHz?: number;
  timeS?: Numbers;
  dtS?: number | Numbers;
}

/** A calibration file, as `shisei calibrate` writes it: its text, or the object that the text holds. Throws
 * {@link DomainError} where it is not whole. */
export type Calibration = string | object;

/** kp as a function of |a|, m/s²: `kpMax` between the starts, falling to `kpMin` at the ends. */
export interface AdaptiveGain {
  /** 1/s, default 2. */
  kpMax?: number;
  /** 1/s, default 0.05. */
  kpMin?: number;
  /** Default 10.3. */
  upperStart?: number;
  /** Default 14.7. */
  upperEnd?: number;
  /** Default 9.3. */
  lowerStart?: number;
  /** Default 4.9. */
  lowerEnd?: number;
}

export interface Settings {
  /** Default `"shisei"`, the estimator's smoother: every attitude from the whole recording. `"shisei-online"`: as it
   * runs live. The others are the classic filters. */
  filter?: "shisei" | "shisei-online" | "mahony" | "mahony-adaptive" | "complementary" | "gyro" | "gyro-rk4";
  /** Mahony: how fast tilt follows the accelerometer, 1/s; default 0.2, 1/kp is the time constant. */
  kp?: number;
  /** Mahony: how fast a gyro bias is learnt, 1/s²; default 0, not at all. */
  ki?: number;
  /** Mahony with a gain that falls while |a| is far from gravity. */
  gain?: AdaptiveGain;
  /** Complementary: share of the gyroscope, default 0.98. */
  alpha?: number;
  /** `"auto"` (default): the first rest of a second is found. First row and row after the last: given. null: none, so
   * no bias is removed. Without a rest the estimator goes on and the classic filters throw {@link ConditionError}. */
  rest?: "auto" | readonly [number, number] | null;
  /** The sensor axis that, laid flat at the start, shall point along world x; default: yaw 0 at the start. */
  forward?: "+x" | "-x" | "+y" | "-y" | "+z" | "-z" | "x" | "y" | "z" | Numbers;
  /** Default 9.80665. */
  gravityMS2?: number;
  /** What is known of the sensor; give raw readings with it. With the filters `"shisei"` and `"shisei-online"` a
   * calibration that the estimator learnt is where it starts from; any other corrects the readings. */
  calibration?: Calibration;
}

/** Attitudes of a recording, and how sure they are (1 sigma). */
export class Orientation {
  private constructor();
  /** N×4, after each sample. */
  readonly worldFromBody: Table;
  /** At the rest, or at the first sample. */
  readonly start: Float64Array;
  /** First row of the rest and the row after its last; undefined without one. */
  readonly rest?: [number, number];
  /** The bias that was removed. */
  readonly gyroBiasRadS: Float64Array;
  /** N; undefined with the classic filters. */
  readonly sigmaTiltRad?: Float64Array;
  /** N, of the heading since the start; undefined with the classic filters. */
  readonly sigmaHeadingRad?: Float64Array;
  /** Doubts about units, readings, the gravity, and a start without a heading, a sentence each. */
  readonly warnings: string[];
  /** N×3 yaw, pitch, roll: of the turn since the start in world axes (default) or in the sensor's axes at the start
   * (`"body"`), or of the attitude itself (`"none"`). */
  yprRad(relative?: "world" | "body" | "none"): Table;
}

/** A whole recording, as `shisei orient` does it, with the same bits: finds the first rest, removes the gyro bias
 * measured there, starts from its attitude. */
export function orient(readings: Recording | Readings, settings?: Settings): Orientation;

/** Mahony's filter, one sample at a time. It holds memory of the module, which the collector of the engine gives back
 * some time; `free()`, or `using mahony = new Mahony()`, at once. */
export class Mahony {
  /** `start`: the attitude before the first sample, default 1, 0, 0, 0. */
  constructor(settings?: { start?: Numbers; kp?: number; ki?: number });
  /** One sample, rad/s, m/s² and the time since the one before, s; gives w, x, y, z. A sample that is not finite leaves
   * the attitude unchanged; a zero acceleration is a step by the gyro alone. */
  update(gyroRadS: Numbers, accMS2: Numbers, dtS: number): Float64Array;
  /** The attitude now. */
  readonly worldFromBody: Float64Array;
  /** The bias learnt so far (with ki > 0). */
  readonly gyroBiasRadS: Float64Array;
  /** Gives its memory back; every later update throws. */
  free(): void;
  [Symbol.dispose](): void;
}

/** What the estimator knows (1 sigma). */
export interface State {
  worldFromBody: Float64Array;
  rateRadS: Float64Array;
  gyroBiasRadS: Float64Array;
  sigmaTiltRad: number;
  sigmaHeadingRad: number;
  rest: boolean;
}

/** The estimator, one sample at a time: starts in motion or at rest, learns the bias, says how sure it is. Its memory is
 * given back as that of {@link Mahony}. */
export class Estimator {
  /** `calibration`: what is known of the sensor; give raw readings with it. */
  constructor(settings?: { gravityMS2?: number; calibration?: Calibration });
  /** One sample, rad/s, m/s² and the time since the one before, s. */
  update(gyroRadS: Numbers, accMS2: Numbers, dtS: number): State;
  /** What is known now. */
  readonly state: State;
  /** Gives its memory back; every later update throws. */
  free(): void;
  [Symbol.dispose](): void;
}
