// Everything that is shown, as numbers in place: a message is written over the one before.

import { yawPitchRoll } from "./angles";
import { History } from "./history";
import { MOST_MARKERS, POSE_COLUMNS, type Poses, type PoseRow, type Scene, type SceneBody, Source } from "./protocol";

/** A body that no message names for so long has vanished. */
const MISSING_MS = 1000;

export class Body {
  readonly position_m = new Float64Array(3);
  /** Turns the body's coordinates into the world's: w, x, y, z. */
  readonly world_from_body = new Float64Array([1, 0, 0, 0]);
  readonly angles_deg = new Float64Array(3);
  readonly history = new History();
  source: Source = Source.None;
  gap_s = 0;
  /** NaN where unknown. */
  sigma_deg = NaN;
  sigma_mm = NaN;
  /** False until a first position came. */
  placed = false;
  /** True when the newest message has a position. */
  located = false;
  /** When the newest pose came, on the page's clock. */
  seen_ms = -Infinity;
  /** Place in the list, for what has no position. */
  order = 0;
  parent: Body | null = null;

  constructor(public what: SceneBody) {}

  get id(): number {
    return this.what.id;
  }

  /** It has a place: one that is true now, or, of what has vanished, the last. */
  get somewhere(): boolean {
    return this.source === Source.None ? this.placed : this.located;
  }

  /** It is a sensor by itself, whose attitude can be set: that of a body comes from the cameras. */
  get settable(): boolean {
    return this.what.kind === "node";
  }
}

export class World {
  /** In the order of the scene. */
  bodies: Body[] = [];
  private readonly byId = new Map<number, Body>();
  /** World coordinates of single markers, m. */
  readonly markers_m = new Float32Array(3 * MOST_MARKERS);
  markerCount = 0;
  time_s = 0;
  frame: number | null = null;
  /** When poses last came, on the page's clock. */
  seen_ms = -Infinity;
  /** Raised by every scene. */
  version = 0;

  body(id: number | null): Body | null {
    return id === null ? null : (this.byId.get(id) ?? null);
  }

  /** A new list of bodies; those that stay keep their pose and their history. */
  change(scene: Scene): void {
    const before = new Map(this.byId);
    this.byId.clear();
    this.bodies = scene.bodies.map((what, order) => {
      const body = before.get(what.id) ?? new Body(what);
      body.what = what;
      body.order = order;
      this.byId.set(what.id, body);
      return body;
    });
    for (const body of this.bodies) {
      const parent = this.body(body.what.parent);
      body.parent = parent === body ? null : parent;
    }
    this.version++;
  }

  take(message: Poses, now_ms: number): void {
    this.time_s = message.time_s;
    this.frame = message.frame;
    this.seen_ms = now_ms;
    for (const row of message.poses) this.takeRow(row, now_ms);
    let count = 0;
    for (const point of message.markers) {
      if (!Array.isArray(point)) continue;
      const [x, y, z] = point;
      if (!Number.isFinite(x) || !Number.isFinite(y) || !Number.isFinite(z)) continue;
      this.markers_m[3 * count] = x;
      this.markers_m[3 * count + 1] = y;
      this.markers_m[3 * count + 2] = z;
      count++;
    }
    this.markerCount = count;
  }

  private takeRow(row: PoseRow, now_ms: number): void {
    if (!Array.isArray(row) || row.length < POSE_COLUMNS) return;
    const [id, px, py, pz, qw, qx, qy, qz, source, gap_s, sigma_deg, sigma_mm] = row;
    const body = typeof id === "number" ? this.byId.get(id) : undefined;
    if (!body) return;
    const known = Number.isFinite(px) && Number.isFinite(py) && Number.isFinite(pz);
    if (known) {
      body.position_m[0] = px as number;
      body.position_m[1] = py as number;
      body.position_m[2] = pz as number;
      body.placed = true;
    }
    body.located = known;
    const length = Math.hypot(qw ?? NaN, qx ?? NaN, qy ?? NaN, qz ?? NaN);
    const turned = length > 0.5 && length < 2;
    if (turned) {
      body.world_from_body[0] = (qw as number) / length;
      body.world_from_body[1] = (qx as number) / length;
      body.world_from_body[2] = (qy as number) / length;
      body.world_from_body[3] = (qz as number) / length;
    }
    body.source = source === 1 || source === 2 || source === 3 ? source : Source.None;
    body.gap_s = typeof gap_s === "number" && Number.isFinite(gap_s) ? gap_s : 0;
    body.sigma_deg = typeof sigma_deg === "number" && sigma_deg >= 0 ? sigma_deg : NaN;
    body.sigma_mm = typeof sigma_mm === "number" && sigma_mm >= 0 ? sigma_mm : NaN;
    body.seen_ms = now_ms;
    const [w = 1, x = 0, y = 0, z = 0] = body.world_from_body;
    yawPitchRoll(w, x, y, z, body.angles_deg);
    body.history.add(this.time_s, body.angles_deg, body.sigma_deg, body.source, known ? body.position_m[0]! : NaN, known ? body.position_m[1]! : NaN, known ? body.position_m[2]! : NaN);
  }

  /** Without a hub nothing is known to be where it was. */
  lost(): void {
    for (const body of this.bodies) body.source = Source.None;
  }

  /** What no message has named for a while has vanished: nothing stands still silently. True when one changed. */
  expire(now_ms: number): boolean {
    let changed = false;
    for (const body of this.bodies) {
      if (body.source !== Source.None && now_ms - body.seen_ms > MISSING_MS) {
        body.source = Source.None;
        changed = true;
      }
      if (body.source === Source.None && Number.isFinite(body.seen_ms)) body.gap_s = Math.max(body.gap_s, (now_ms - body.seen_ms) / 1000);
    }
    return changed;
  }
}
