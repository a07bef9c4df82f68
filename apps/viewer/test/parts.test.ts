import assert from "node:assert/strict";
import { test } from "node:test";
import { streamAddress, wait_ms } from "../src/connection";
import { History, KEPT } from "../src/history";
import { hull } from "../src/hull";
import { Pace } from "../src/pace";
import { load } from "../src/settings";
import { texts, type Key } from "../src/text";
import { niceRange } from "../src/ui/graph";
import { deedOf } from "../src/ui/keys";
import { bytes, clock, fixed, wrapped } from "../src/ui/numbers";
import type { Point } from "../src/protocol";

test("the stream's address carries the page's token and nothing else", () => {
  assert.equal(streamAddress({ protocol: "http:", host: "127.0.0.1:8080", search: "?lang=ja" }), "ws://127.0.0.1:8080/stream");
  assert.equal(streamAddress({ protocol: "https:", host: "lab:1", search: "?token=a%2Bb%26c&lang=en" }), "wss://lab:1/stream?token=a%2Bb%26c");
});

test("waits grow and stop growing", () => {
  const waits = [0, 1, 2, 3, 10, 1e9].map((attempt) => wait_ms(attempt, 0.5));
  for (let k = 1; k < waits.length; k++) assert(waits[k]! >= waits[k - 1]!);
  assert(waits[0]! <= 600 && waits[5]! <= 5000);
});

test("a history holds the newest, unwraps angles and starts again when time jumps back", () => {
  const history = new History();
  const angles = new Float64Array(3);
  for (let k = 0; k < KEPT + 10; k++) {
    angles[0] = ((k * 7 + 180) % 360) - 180;
    history.add(k, angles, 0.1, 1, k, 0, 0);
  }
  assert.equal(history.count, KEPT);
  assert.equal(history.time_s[history.at(0)], KEPT + 9);
  assert.equal(history.angles_deg[0][history.at(0)], 7 * (KEPT + 9));
  assert.equal(history.at(KEPT), -1);
  history.add(3, angles, 0, 1, 0, 0, 0);
  assert.equal(history.count, 1);
});

test("the hull of a cube has its 12 edges and no diagonals", () => {
  const cube = [0, 1].flatMap((x) => [0, 1].flatMap((y) => [0, 1].map((z): Point => [x, y, z])));
  const { edges } = hull([...cube, [0.5, 0.5, 0.5]]);
  assert.equal(edges.length / 2, 12);
  for (let k = 0; k < edges.length; k += 2) {
    const [a, b] = [cube[edges[k]!]!, cube[edges[k + 1]!]!];
    assert.equal(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 1);
  }
});

test("hulls of a tetrahedron, a square, a line, a point, the same point thrice", () => {
  assert.equal(hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).edges.length / 2, 6);
  assert.equal(hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).faces.length / 3, 4);
  const square = hull([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]);
  assert.equal(square.edges.length / 2, 4);
  const pairs = Array.from({ length: 4 }, (_, k) => [square.edges[2 * k]!, square.edges[2 * k + 1]!].sort().join());
  assert(!pairs.includes("0,1") && !pairs.includes("2,3"), "no diagonals");
  assert.deepEqual(hull([[0, 0, 0], [2, 0, 0], [1, 0, 0]]).edges.length / 2, 2);
  assert.deepEqual(hull([[0, 0, 0]]).edges, []);
  hull([[1, 1, 1], [1, 1, 1], [1, 1, 1]]);
});

test("both languages have every text, with the same places for values, and they differ", () => {
  const same = new Set<Key>(["title"]);
  for (const key of Object.keys(texts.en) as Key[]) {
    const [en, ja] = [texts.en[key], texts.ja[key]];
    assert(en.length > 0 && ja.length > 0, key);
    assert.deepEqual([...en.matchAll(/\{\d\}/g)].map(String).sort(), [...ja.matchAll(/\{\d\}/g)].map(String).sort(), key);
    assert(same.has(key) || en !== ja, key);
  }
});

test("address over memory over browser", () => {
  assert.equal(load("", null, ["fr", "ja-JP", "en"]).lang, "ja");
  assert.equal(load("", '{"lang":"en"}', ["ja"]).lang, "en");
  assert.equal(load("?lang=ja", '{"lang":"en"}', ["en"]).lang, "ja");
  assert.equal(load("?lang=xx", "no json", []).lang, "en");
  assert.equal(load("", "null", []).trails, true);
  assert.equal(load("", '{"trails":false,"theme":"dark"}', []).theme, "dark");
});

test("keys", () => {
  const press = (key: string, more: object = {}): ReturnType<typeof deedOf> => deedOf({ key, shiftKey: false, ctrlKey: false, altKey: false, metaKey: false, repeat: false, ...more });
  assert.equal(press("r"), "record");
  assert.equal(press("R", { shiftKey: true }), "record");
  assert.equal(press("r", { ctrlKey: true }), null);
  assert.equal(press("r", { repeat: true }), null);
  assert.equal(press("ArrowLeft", { repeat: true }), "left");
  assert.equal(press("ArrowLeft", { shiftKey: true }), "moveLeft");
  assert.equal(press("?", { shiftKey: true }), "help");
  assert.equal(press("q"), null);
});

test("numbers as people read them", () => {
  assert.deepEqual([fixed(-0.04, 1), fixed(-1.25, 1), fixed(null, 1), fixed(NaN, 1), fixed(2, 1, "°")], ["0.0", "−1.3", "–", "–", "2.0°"]);
  assert.deepEqual([clock(7.9), clock(754), clock(3723)], ["0:07", "12:34", "1:02:03"]);
  assert.deepEqual([bytes(12), bytes(12345), bytes(1.23e6), bytes(4.5e9)], ["12 B", "12 kB", "1.2 MB", "4.50 GB"]);
  assert.deepEqual([wrapped(190), wrapped(-725)], [-170, -5]);
});

test("a range holds its values in a few whole steps", () => {
  for (const [low, high] of [[-3, 4], [0, 0], [-170, 175], [100, 101], [-1000, 2000], [0, 1e6]] as const) {
    const range = niceRange(low, high);
    const steps = (range.high - range.low) / range.step;
    assert(range.low <= low && range.high >= high, `${low} … ${high}`);
    assert(steps >= 2 && steps <= 6 && Number.isInteger(steps), `${low} … ${high}: ${steps}`);
  }
});

test("the pace of frames", () => {
  const pace = new Pace();
  for (let k = 1; k <= 300; k++) pace.add(k * 20, 3);
  assert(Math.abs(pace.read().fps - 50) < 0.5);
  assert.equal(pace.read().work_ms, 3);
});
