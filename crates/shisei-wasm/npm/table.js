// Numbers in rows and columns, and what a caller gives as such.
import { DomainError, ShapeError, say } from "./state.js";

/** Numbers row after row. */
export class Table {
  constructor(data, rows, columns) {
    const whole = [rows, columns].every((count) => Number.isInteger(count) && count >= 0);
    if (!(data instanceof Float64Array && whole && data.length === rows * columns)) {
      throw new ShapeError(say(`a Table takes a Float64Array of rows × columns numbers; there are ${data?.length} for ${rows} × ${columns}`,
        `Table には rows × columns 個の数値の Float64Array が必要です (${rows} × ${columns} に対して ${data?.length} 個)`));
    }
    this.data = data;
    this.rows = rows;
    this.columns = columns;
  }

  /** A row, sharing the numbers. */
  row(k) {
    within(k, this.rows, "row");
    return this.data.subarray(k * this.columns, (k + 1) * this.columns);
  }

  /** A column, copied. */
  column(k) {
    within(k, this.columns, "column");
    return Float64Array.from({ length: this.rows }, (_, row) => this.data[row * this.columns + k]);
  }

  *[Symbol.iterator]() {
    for (let k = 0; k < this.rows; k += 1) {
      yield this.row(k);
    }
  }
}

/** Refuses a row or column that the table does not have. */
function within(k, count, what) {
  if (!(Number.isInteger(k) && k >= 0 && k < count)) {
    throw new DomainError(say(`${what} ${String(k)} of a Table that has ${count}; they count from 0`,
      `Table の ${what} は ${count} 個ですが、${String(k)} が指定されました (0 から数えます)`));
  }
}

/** A result of the module as a table. */
export const table = ([data, rows, columns]) => new Table(data, rows, columns);

const isList = (value) => Array.isArray(value) || (ArrayBuffer.isView(value) && !(value instanceof DataView));

/** Numbers of a flat list; everything in it must be one. */
function numbers(list, name) {
  const strange = Array.isArray(list) ? list.findIndex((value) => typeof value !== "number") : -1;
  if (strange >= 0 || typeof list[0] === "bigint") {
    const [at, value] = [Math.max(strange, 0), String(list[Math.max(strange, 0)])];
    throw new ShapeError(say(`${name}: value ${at + 1} is ${value} and must be a number`,
      `${name}：${at + 1} 番目の値が ${value} です。数値を指定してください`));
  }
  return list instanceof Float64Array ? list : Float64Array.from(list);
}

/** Any rectangle of numbers: a table, rows, or the numbers of one row; of several, where their length is known. */
export function rectangle(value, name, length) {
  if (value instanceof Table) {
    return value;
  }
  if (!isList(value)) {
    throw new ShapeError(say(`${name} must be an array of numbers, of rows, or a Table`,
      `${name} には数値の配列、行の配列、または Table を指定してください`));
  }
  if (!isList(value[0])) {
    const columns = length && value.length % length === 0 ? length : value.length;
    return new Table(numbers(value, name), value.length / (columns || 1), columns);
  }
  const columns = value[0].length;
  const data = new Float64Array(value.length * columns);
  value.forEach((row, k) => {
    if (!isList(row) || row.length !== columns) {
      throw new ShapeError(say(`${name}: row ${k + 1} must have ${columns} numbers, as the first has`,
        `${name}：${k + 1} 行目は 1 行目と同じ ${columns} 個の数値でなければなりません`));
    }
    data.set(numbers(row, name), k * columns);
  });
  return new Table(data, value.length, columns);
}

/** Samples of so many numbers. */
export function series(value, columns, name) {
  const found = rectangle(value, name, columns);
  if (found.columns !== columns) {
    throw new ShapeError(say(`${name} is ${found.rows}×${found.columns} and must be N×${columns}, one sample a row`,
      `${name} は ${found.rows}×${found.columns} ですが、N×${columns} (1 行に 1 サンプル) でなければなりません`));
  }
  return found;
}

/** So many numbers. */
export function vector(value, length, name) {
  const { data } = rectangle(value, name);
  if (data.length !== length) {
    throw new ShapeError(say(`${name} has ${data.length} numbers and must have ${length}`,
      `${name} の数値は ${data.length} 個ですが、${length} 個でなければなりません`));
  }
  return data;
}

/** So many finite numbers. */
export function finiteVector(value, length, name) {
  const found = vector(value, length, name);
  if (!found.every(Number.isFinite)) {
    throw new DomainError(say(`${name} is ${found.join(", ")}; every number must be finite`,
      `${name} が ${found.join(", ")} です。すべて有限の数値にしてください`));
  }
  return found;
}

/** w, x, y, z of a rotation, of any norm but zero. */
export function quaternion(value, name) {
  const found = finiteVector(value, 4, name);
  if (found.every((part) => part === 0)) {
    throw new DomainError(say(`${name} is zero and has no direction; give w, x, y, z of a rotation`,
      `${name} がゼロで、向きが決まりません。回転を表す w, x, y, z を指定してください`));
  }
  return found;
}

/** One number. */
export function number(value, name) {
  if (typeof value !== "number") {
    throw new ShapeError(say(`${name} is ${String(value)} and must be a number`,
      `${name} が ${String(value)} です。数値を指定してください`));
  }
  return value;
}

/** A sampling rate, Hz. */
export function rate(value) {
  if (!(number(value, "rateHz") > 0 && value < Infinity)) {
    throw new DomainError(say(`rateHz is ${value}; it must be a finite number greater than 0`,
      `rateHz が ${value} です。0 より大きい有限の数値にしてください`));
  }
  return value;
}

const usable = (step) => step > 0 && step < Infinity;

/** The step, from the one of `rateHz`, `timeS` and `dtS` that is given: one number, or one a sample. */
export function steps(rows, { rateHz, timeS, dtS }) {
  if ([rateHz, timeS, dtS].filter((given) => given !== undefined).length !== 1) {
    throw new TypeError(say("give exactly one of rateHz, timeS and dtS", "rateHz、timeS、dtS のうち 1 つだけを指定してください"));
  }
  if (rateHz !== undefined) {
    return Float64Array.of(1 / rate(rateHz));
  }
  if (dtS !== undefined) {
    const step = typeof dtS === "number" ? Float64Array.of(dtS) : vector(dtS, rows, "dtS");
    const wrong = step.findIndex((length) => !usable(length));
    if (wrong >= 0) {
      throw new DomainError(say(`dtS must be finite and greater than 0; row ${wrong + 1} is ${step[wrong]}`,
        `dtS は 0 より大きい有限の数値でなければなりません。${wrong + 1} 行目が ${step[wrong]} です`));
    }
    return step;
  }
  const time = vector(timeS, rows, "timeS");
  if (rows < 2) {
    throw new ShapeError(say("timeS needs at least two samples; give rateHz for one",
      "timeS には 2 サンプル以上が必要です。1 サンプルなら rateHz を指定してください"));
  }
  const step = time.map((at, k) => at - time[k - 1]);
  const row = step.findIndex((length, k) => k > 0 && !usable(length));
  if (row > 0) {
    throw new DomainError(say(`timeS must rise from row to row; row ${row + 1} is ${time[row]} after ${time[row - 1]}`,
      `timeS は行ごとに増えなければなりません。${row + 1} 行目は ${time[row - 1]} の次が ${time[row]} です`));
  }
  const sorted = step.slice(1).sort();
  const middle = sorted.length / 2;
  step[0] = sorted.length % 2 ? sorted[Math.floor(middle)] : (sorted[middle - 1] + sorted[middle]) / 2;
  return step;
}
