// Whether the module is loaded, in which language it speaks, and errors in that language.
import * as wasm from "./wasm/shisei.js";

let ready = false;

/** The module is there; sentences are in the language of the surroundings. */
export function loaded(locale) {
  if (!ready) {
    ready = true;
    wasm.setJapanese(locale.toLowerCase().startsWith("ja"));
  }
}

/** The module, once it is loaded. */
export function native() {
  if (!ready) {
    throw new Error("shisei is not loaded yet: call `await init()` first");
  }
  return wasm;
}

/** An array has the wrong shape, or lengths differ. */
export class ShapeError extends Error {
  name = "ShapeError";
}

/** A value is out of range, zero where it may not be, or not finite. */
export class DomainError extends Error {
  name = "DomainError";
}

/** The data do not meet a condition: not at rest, a face missing. */
export class ConditionError extends Error {
  name = "ConditionError";
}

/** A file is not a recording that can be read. */
export class RecordingError extends Error {
  name = "RecordingError";
}

const KINDS = { ShapeError, DomainError, ConditionError, RecordingError };

/** What `run` gives; what it throws becomes an error of its kind. */
export function kindly(run) {
  try {
    return run(native());
  } catch (error) {
    const Kind = KINDS[error?.name];
    throw Kind && !(error instanceof Kind) ? new Kind(error.message) : error;
  }
}

/** The sentence of the language in use. */
export function say(en, ja) {
  return native().language() === "ja" ? ja : en;
}
