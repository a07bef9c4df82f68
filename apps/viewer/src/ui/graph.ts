// Yaw, pitch and roll of the last seconds: three plots on one canvas, the expected error as a band, and below them a
// strip that says who carried the body: drawn through, dashed, dotted, as everywhere.

import { type Look, Pattern } from "../source";
import { Source } from "../protocol";
import { say } from "../text";
import type { Body } from "../world";

const WINDOW_S = 10;
const LEFT = 42;
const RIGHT = 4;
const TOP = 8;
const BETWEEN = 18;
const STRIP = 22;
const STEPS = [1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720, 1440];
const NAMES = ["yaw", "pitch", "roll"] as const;
const TONES = ["--tone-z", "--tone-y", "--tone-x"] as const;

/** A range of whole steps round low and high, at least two steps wide; the same until the values leave it. */
export function niceRange(low: number, high: number): { low: number; high: number; step: number } {
  const middle = (low + high) / 2;
  const half = Math.max(2, (high - low) / 2);
  const step = STEPS.find((candidate) => 2 * half <= 3 * candidate) ?? Math.ceil((2 * half) / 3 / 360) * 360;
  const first = Math.floor(Math.min(low, middle - half / 2) / step) * step;
  return { low: first, high: Math.max(first + 2 * step, Math.ceil(Math.max(high, middle + half / 2) / step) * step), step };
}

export class Graph {
  private readonly pen: CanvasRenderingContext2D | null;
  private tones: string[] = [];
  private quiet = "#888";
  private line = "#ccc";
  private looks: readonly Look[] = [];

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.pen = canvas.getContext("2d");
  }

  setTheme(looks: readonly Look[]): void {
    const style = getComputedStyle(document.documentElement);
    this.tones = TONES.map((name) => style.getPropertyValue(name).trim());
    this.quiet = style.getPropertyValue("--quiet").trim();
    this.line = style.getPropertyValue("--line").trim();
    this.looks = looks;
  }

  draw(body: Body, now_s: number): void {
    const { pen, canvas } = this;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (!pen || width < 80 || height < 80) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = `11px ${getComputedStyle(canvas).fontFamily}`;
    const each = (height - TOP - STRIP - 2 * BETWEEN) / 3;
    for (let axis = 0; axis < 3; axis++) this.plot(pen, body, axis, now_s, width, TOP + axis * (each + BETWEEN), each);
    this.strip(pen, body, now_s, width, height - STRIP);
  }

  private plot(pen: CanvasRenderingContext2D, body: Body, axis: number, now_s: number, width: number, top: number, height: number): void {
    const { history } = body;
    const values = history.angles_deg[axis]!;
    let low = Infinity;
    let high = -Infinity;
    for (let back = 0; back < history.count; back++) {
      const k = history.at(back);
      if (now_s - history.time_s[k]! > WINDOW_S) break;
      if (history.source[k] === Source.None) continue;
      const spread = Math.min(45, history.sigma_deg[k]! || 0);
      low = Math.min(low, values[k]! - spread);
      high = Math.max(high, values[k]! + spread);
    }
    if (!(low <= high)) [low, high] = [-5, 5];
    const range = niceRange(low, high);
    const x = (time_s: number): number => width - RIGHT - ((now_s - time_s) / WINDOW_S) * (width - LEFT - RIGHT);
    const y = (value: number): number => top + height - ((value - range.low) / (range.high - range.low)) * height;

    pen.strokeStyle = this.line;
    pen.fillStyle = this.quiet;
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    pen.beginPath();
    for (let tick = range.low; tick <= range.high + 1e-9; tick += range.step) {
      const at = Math.round(y(tick)) + 0.5;
      pen.moveTo(LEFT, at);
      pen.lineTo(width - RIGHT, at);
      pen.fillText(`${tick < 0 ? "−" : ""}${Math.abs(tick)}°`, LEFT - 6, at);
    }
    pen.stroke();

    const tone = this.tones[axis]!;
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, top - 2, width - LEFT - RIGHT, height + 4);
    pen.clip();
    pen.fillStyle = tone;
    pen.strokeStyle = tone;
    this.band(pen, body, values, now_s, x, y);
    this.curve(pen, body, values, now_s, x, y);
    pen.restore();
    pen.fillStyle = tone;
    pen.textAlign = "left";
    pen.textBaseline = "top";
    pen.fillText(say(NAMES[axis]!), LEFT + 4, top + 2);
  }

  private band(pen: CanvasRenderingContext2D, body: Body, values: Float64Array, now_s: number, x: (t: number) => number, y: (v: number) => number): void {
    const { history } = body;
    pen.globalAlpha = 0.2;
    pen.beginPath();
    let last = -1;
    for (let back = 0; back < history.count; back++) {
      const k = history.at(back);
      if (now_s - history.time_s[k]! > WINDOW_S) break;
      const spread = history.sigma_deg[k]! || 0;
      if (back === 0) pen.moveTo(x(history.time_s[k]!), y(values[k]! + spread));
      else pen.lineTo(x(history.time_s[k]!), y(values[k]! + spread));
      last = back;
    }
    for (let back = last; back >= 0; back--) {
      const k = history.at(back);
      pen.lineTo(x(history.time_s[k]!), y(values[k]! - (history.sigma_deg[k]! || 0)));
    }
    pen.fill();
    pen.globalAlpha = 1;
  }

  private curve(pen: CanvasRenderingContext2D, body: Body, values: Float64Array, now_s: number, x: (t: number) => number, y: (v: number) => number): void {
    const { history } = body;
    pen.lineWidth = 1.7;
    pen.lineJoin = "round";
    pen.beginPath();
    let drawing = false;
    for (let back = 0; back < history.count; back++) {
      const k = history.at(back);
      if (now_s - history.time_s[k]! > WINDOW_S + 0.1) break;
      if (history.source[k] === Source.None) {
        drawing = false;
        continue;
      }
      if (drawing) pen.lineTo(x(history.time_s[k]!), y(values[k]!));
      else pen.moveTo(x(history.time_s[k]!), y(values[k]!));
      drawing = true;
    }
    pen.stroke();
  }

  /** Who carried the body: one run of moments of the same source after another. */
  private strip(pen: CanvasRenderingContext2D, body: Body, now_s: number, width: number, top: number): void {
    const { history } = body;
    const x = (time_s: number): number => Math.max(LEFT, width - RIGHT - ((now_s - time_s) / WINDOW_S) * (width - LEFT - RIGHT));
    const run = (source: number, from_s: number, to_s: number): void => {
      const look = this.looks[source];
      if (!look) return;
      pen.strokeStyle = look.css;
      pen.lineWidth = source === Source.None ? 1.5 : 4;
      pen.setLineDash(look.pattern === Pattern.Dashed ? [7, 3] : look.pattern === Pattern.Dotted ? [2, 3] : []);
      pen.beginPath();
      pen.moveTo(x(from_s), top + 4);
      pen.lineTo(x(to_s), top + 4);
      pen.stroke();
    };
    let end = now_s;
    for (let back = 0; back < history.count; back++) {
      const k = history.at(back);
      const before = history.at(back + 1);
      const time = history.time_s[k]!;
      const last = before < 0 || now_s - time > WINDOW_S;
      if (last || history.source[before] !== history.source[k]) {
        run(history.source[k]!, time, end);
        end = time;
      }
      if (last) break;
    }
    pen.setLineDash([]);
    pen.fillStyle = this.quiet;
    pen.textBaseline = "bottom";
    for (const back of [0, 5, 10]) {
      pen.textAlign = back === 0 ? "right" : back === 10 ? "left" : "center";
      pen.fillText(back === 0 ? "0 s" : `−${back}`, width - RIGHT - (back / WINDOW_S) * (width - LEFT - RIGHT), top + STRIP);
    }
  }
}
