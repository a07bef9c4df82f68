import assert from "node:assert/strict";
import { test } from "node:test";
import { MOST_BODIES, parse, Source } from "../src/protocol";
import { World } from "../src/world";

const body = (id: number, more: object = {}): object => ({ id, name: `B${id}`, kind: "body", skeleton: null, parent: null, node: null, markers: [[0, 0, 0.1]], ...more });
const row = (id: unknown, ...rest: unknown[]): unknown[] => [id, ...(rest.length ? rest : [1, 2, 3, 1, 0, 0, 0, 1, 0, 0.2, 0.4])];
const message = (value: object): ReturnType<typeof parse> => parse(JSON.stringify(value));

function world(...bodies: object[]): World {
  const made = new World();
  const scene = message({ type: "scene", bodies });
  assert(scene?.type === "scene");
  made.change(scene);
  return made;
}

function feed(to: World, value: object, now_ms = 0): void {
  const poses = message({ type: "poses", time_s: 1, frame: null, poses: [], markers: [], ...value });
  assert(poses?.type === "poses");
  to.take(poses, now_ms);
}

test("what is no message is nothing", () => {
  for (const text of ["", "{", "null", "7", "[]", '"poses"', "{}", '{"type":5}', '{"type":"other"}', '{"type":"hello"}', '{"type":"poses"}', '{"type":"note"}', '{"type":"poses","time_s":"1"}']) {
    assert.equal(parse(text), null, text);
  }
});

test("a scene keeps what is sound and drops the rest", () => {
  const scene = message({ type: "scene", bodies: [body(1), body(1, { name: "again" }), { id: "2" }, null, 5, body(3, { kind: "ghost", markers: [[1, 2], [1, 2, null], "x", [1e9, 0, 0], [1, 2, 3]] })] });
  assert(scene?.type === "scene");
  assert.deepEqual(scene.bodies.map((b) => b.id), [1, 3]);
  assert.equal(scene.bodies[1]!.kind, "body");
  assert.deepEqual(scene.bodies[1]!.markers, [[1, 2, 3]]);
});

test("sizes are bounded", () => {
  const scene = message({ type: "scene", bodies: Array.from({ length: 3 * MOST_BODIES }, (_, id) => body(id, { name: "n".repeat(5000) })) });
  assert(scene?.type === "scene");
  assert.equal(scene.bodies.length, MOST_BODIES);
  assert(scene.bodies[0]!.name.length < 200);
  const made = world(body(1));
  feed(made, { markers: Array.from({ length: 50000 }, () => [1, 2, 3]) });
  assert(made.markerCount < 50000);
});

test("a pose is taken, normalised, and its source kept", () => {
  const made = world(body(1));
  feed(made, { poses: [row(1, 0.5, -1, 2, 0.9, 0, 0, 0.9, 2, 1.5, 0.7, 12)] });
  const [one] = made.bodies;
  assert(one);
  assert.deepEqual([...one.position_m], [0.5, -1, 2]);
  assert(Math.abs(Math.hypot(...one.world_from_body) - 1) < 1e-15);
  assert.equal(one.source, Source.Bridged);
  assert.equal(one.gap_s, 1.5);
  assert.equal(one.sigma_mm, 12);
  assert(Math.abs(one.angles_deg[0]! - 90) < 1e-9);
});

test("rows that are no poses change nothing", () => {
  const made = world(body(1));
  feed(made, { poses: [row(1)] });
  feed(made, { poses: [null, 5, "x", [], [1], row(99), row("1"), row(null), { 0: 1, length: 12 }], markers: [null, 3, [1], ["a", 1, 2], [1, 2, 3]] });
  assert.deepEqual([...made.bodies[0]!.position_m], [1, 2, 3]);
  assert.equal(made.markerCount, 1);
  feed(made, { poses: [row(1, null, null, null, 0, 0, 0, 0, 3, -1, null, null)] });
  assert.deepEqual([...made.bodies[0]!.world_from_body], [1, 0, 0, 0]);
  assert.equal(made.bodies[0]!.located, false);
  assert.equal(made.bodies[0]!.source, Source.Inertial);
  assert(Number.isNaN(made.bodies[0]!.sigma_deg));
  feed(made, { poses: [row(1, 1, 2, 3, 1, 0, 0, 0, 77, 0, 0, 0)] });
  assert.equal(made.bodies[0]!.source, Source.None);
});

test("a position that is lost is not shown, that of what has vanished stays", () => {
  const made = world(body(1), body(2, { kind: "node" }));
  const [one, node] = made.bodies;
  assert(one && node);
  const shown = (...rows: unknown[][]): boolean[] => {
    feed(made, { poses: rows });
    return [one.somewhere, node.somewhere];
  };
  const gone = [null, null, null, 1, 0, 0, 0];
  assert.deepEqual(shown(row(1), row(2, ...gone, 3, 0, 1, null)), [true, false]);
  assert.deepEqual(shown(row(1, 1, 2, 3, 1, 0, 0, 0, 2, 4.9, 1, 300)), [true, false]);
  assert.deepEqual(shown(row(1, ...gone, 3, 5.1, 1, null)), [false, false]);
  assert.deepEqual(shown(row(1, ...gone, 0, 9, null, null), row(2, ...gone, 0, 9, null, null)), [true, false]);
  assert.deepEqual([...one.position_m], [1, 2, 3]);
  assert.deepEqual([one.settable, node.settable], [false, true]);
});

test("what no message names has vanished after a second", () => {
  const made = world(body(1), body(2));
  feed(made, { poses: [row(1), row(2)] }, 0);
  feed(made, { poses: [row(2)] }, 900);
  assert.equal(made.expire(1000), false);
  assert.equal(made.expire(1200), true);
  assert.deepEqual(made.bodies.map((b) => b.source), [Source.None, Source.Optical]);
  assert(made.bodies[0]!.gap_s >= 1.2);
});

test("bodies that stay keep their pose when the scene changes; a body is never its own parent", () => {
  const made = world(body(1), body(2, { parent: 1 }));
  feed(made, { poses: [row(1)] });
  const [one] = made.bodies;
  const scene = message({ type: "scene", bodies: [body(3, { parent: 3 }), body(1, { name: "new" })] });
  assert(scene?.type === "scene");
  made.change(scene);
  assert.equal(made.bodies[1], one);
  assert.equal(one!.what.name, "new");
  assert.equal(made.bodies[0]!.parent, null);
  assert.equal(made.body(2), null);
});

test("a status with holes is still a status", () => {
  const status = message({ type: "status", inputs: [{}, null], nodes: [{ name: 5, battery_v: "x" }], recording: { file: "a.mcap" } });
  assert(status?.type === "status");
  assert.equal(status.nodes[0]!.battery_v, null);
  assert.deepEqual(status.recording, { file: "a.mcap", seconds: 0, bytes: 0 });
  assert.equal(status.latency_ms.median, null);
});
