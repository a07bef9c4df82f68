// The world as bars, balls and faces, written anew for every frame into arrays that stay: nothing is allocated here.

import type { Settings, Theme } from "../settings";
import { hull } from "../hull";
import { lookOf, type Look, Pattern } from "../source";
import { Source, type Point } from "../protocol";
import type { Body, World } from "../world";
import { Dots, Shape as Round } from "./dots";
import { Faces } from "./faces";
import { Ground } from "./ground";
import { Label } from "./labels";
import { Links } from "./links";
import type { Stage } from "./stage";
import { Trails } from "./trails";

/** Sides of a round bar, and where every corner counts. */
const SIDES = 8;
const FEW_SIDES = 6;
/** Radii at both ends, m, and how solid. */
const bar = (from_m: number, to_m: number, solidity: number): Float32Array => new Float32Array([from_m, to_m, solidity]);
const EDGE = bar(0.003, 0.003, 1);
const EDGE_CHOSEN = bar(0.0045, 0.0045, 1);
const AXIS = bar(0.0042, 0.0042, 1);
const AXIS_FAINT = bar(0.0042, 0.0042, 0.6);
const BONE = bar(0.018, 0.009, 0.92);
const DROP = bar(0.0008, 0.0008, 0.16);
const DROP_CHOSEN = bar(0.0008, 0.0008, 0.5);
/** Radius, m, and how solid. */
const dot = (radius_m: number, solidity = 1): Float32Array => new Float32Array([radius_m, solidity]);
const MARKER = dot(0.008);
const SINGLE = dot(0.0064);
const JOINT = dot(0.02);
const CROSS = dot(0.035, 2);
const INSIDE_SEEN = new Float32Array([0.09]);
const INSIDE = new Float32Array([0.05]);
/** A node's box, and that of a body without markers: half sizes, m. */
const NODE_BOX = [0.03, 0.02, 0.008] as const;
const PLAIN_BOX = [0.06, 0.04, 0.02] as const;
/** More names than this hide each other on a narrow screen; that of the chosen body is shown all the same. */
const CROWD = 8;
const NARROW_PX = 720;
/** Where bodies stand that have no position: in a row. */
const ROW = { x: -1.1, y: -1, step: 0.4, z: 1 } as const;

const AXES = [new Float32Array([0.88, 0.27, 0.25, 1]), new Float32Array([0.2, 0.66, 0.32, 1]), new Float32Array([0.25, 0.45, 0.95, 1])] as const;

/** What the scene says of a body's shape, made once. */
interface Form {
  /**
   * In the body's frame: markers or corners, then the origin and the tips of the three axes; in the world the same,
   * then the place on the floor below and the bone it hangs on.
   */
  local: Float32Array;
  world: Float32Array;
  /** Markers or corners. */
  points: number;
  edges: Uint16Array;
  faces: Uint16Array;
  /** What rings it when it is chosen. */
  ring: Float32Array;
  /** Real markers are shown as balls, corners of a box are not. */
  balls: boolean;
  label: Label | null;
  shownSource: number;
}

const box = ([x, y, z]: readonly [number, number, number]): Point[] =>
  [-1, 1].flatMap((a) => [-1, 1].flatMap((b) => [-1, 1].map((c): Point => [a * x, b * y, c * z])));

export class Picture {
  private readonly links: Links;
  private readonly dots: Dots;
  private readonly marks: Dots;
  private readonly spots: Dots;
  private readonly faces = new Faces(8000);
  private readonly trails = new Trails(100);
  private readonly ground: Ground;
  private forms: Form[] = [];
  private looks: readonly Look[] = [];
  private theme: Theme = "light";
  private readonly markerTint = new Float32Array([0.5, 0.5, 0.5, 1]);
  private readonly shade = new Float32Array([0, 0, 0, 1]);
  private readonly drop = new Float32Array([0.5, 0.5, 0.5, 1]);
  private version = -1;
  private readonly place = new Float64Array(3);
  private readonly size = new Float32Array(2);
  private named = 0;
  private crowded = false;

  constructor(private readonly stage: Stage, private readonly world: World, private readonly settings: Settings) {
    const card = !stage.bySoftware;
    this.links = new Links(12000, card ? SIDES : FEW_SIDES, card);
    this.dots = new Dots(12000, true, 3, card);
    this.marks = new Dots(3000, false, 4, card);
    this.spots = new Dots(1000, false, 1, card);
    this.ground = new Ground(stage.bySoftware);
    stage.scene.add(this.ground.mesh, this.spots.mesh, this.faces.mesh, this.trails.lines, this.links.mesh, this.dots.mesh, this.marks.mesh);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.looks = [0, 1, 2, 3].map((source) => lookOf(theme, source));
    const dark = theme === "dark";
    if (dark) this.ground.setInk(0.75, 0.82, 0.95, 0.34);
    else this.ground.setInk(0.16, 0.22, 0.36, 0.34);
    this.markerTint.set(dark ? [0.82, 0.86, 0.92, 1] : [0.36, 0.41, 0.5, 1]);
    this.shade.set(dark ? [0, 0, 0, 1] : [0.1, 0.14, 0.22, 1]);
    this.drop.set(dark ? [0.8, 0.86, 0.95, 1] : [0.2, 0.26, 0.4, 1]);
    for (const form of this.forms) form.shownSource = -1;
  }

  /** Sizes that follow the canvas. */
  resized(): void {
    const { unit } = this.stage;
    for (const part of [this.links, this.dots, this.marks, this.spots]) part.setPixel(unit);
    for (const form of this.forms) form.label?.size(unit);
  }

  /** Labels are painted anew: the choice or a name has changed. */
  relabel(): void {
    for (const form of this.forms) form.shownSource = -1;
  }

  private rebuild(): void {
    this.version = this.world.version;
    for (const form of this.forms) {
      if (form.label) this.stage.scene.remove(form.label.sprite);
      form.label?.dispose();
    }
    const labelled = new Set<string>();
    this.forms = this.world.bodies.map(({ what }) => {
      const own = what.markers.length > 0;
      const points = what.kind === "bone" ? [] : own ? what.markers : box(what.kind === "node" ? NODE_BOX : PLAIN_BOX);
      const shape = hull(points);
      let size = 0;
      for (const [x, y, z] of points) size = Math.max(size, Math.hypot(x, y, z));
      // of a skeleton only the root has its name shown
      const named = what.kind !== "bone" || (what.skeleton !== null && !labelled.has(what.skeleton));
      if (what.kind === "bone" && what.skeleton !== null) labelled.add(what.skeleton);
      const label = named ? new Label() : null;
      if (label) {
        label.size(this.stage.unit);
        this.stage.scene.add(label.sprite);
      }
      const axis = what.kind === "bone" ? 0.05 : Math.min(0.16, Math.max(0.07, 0.9 * size));
      return {
        local: new Float32Array([...points.flat(), 0, 0, 0, axis, 0, 0, 0, axis, 0, 0, 0, axis]),
        world: new Float32Array(3 * (points.length + 6)),
        points: points.length,
        edges: new Uint16Array(shape.edges),
        faces: new Uint16Array(shape.faces),
        ring: dot(what.kind === "bone" ? 0.032 : 1.15 * axis),
        balls: own,
        label,
        shownSource: -1,
      };
    });
    this.named = this.forms.filter((form) => form.label !== null).length;
  }

  /** Where a body is drawn: its place, or one in the row of those that have none. */
  placeOf(body: Body, out: Float64Array): void {
    if (body.somewhere) {
      out.set(body.position_m);
      return;
    }
    out[0] = ROW.x;
    out[1] = ROW.y + ROW.step * (body.order % 8);
    out[2] = ROW.z;
  }

  /** The body nearest to a point of the canvas, within `reach` pixels. */
  pick(x: number, y: number, reach: number): Body | null {
    const at = { x: 0, y: 0 };
    let best: Body | null = null;
    let nearest = reach;
    for (const body of this.world.bodies) {
      this.placeOf(body, this.place);
      if (!this.stage.project(this.place[0]!, this.place[1]!, this.place[2]!, at)) continue;
      const far = Math.hypot(at.x - x, at.y - y) + (body.what.kind === "bone" ? 4 : 0);
      if (far < nearest) [best, nearest] = [body, far];
    }
    return best;
  }

  /** A ball round everything that has a place, as x, y, z, radius; false when nothing has. */
  extent(out: Float64Array): boolean {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const body of this.world.bodies) {
      this.placeOf(body, this.place);
      for (let axis = 0; axis < 3; axis++) {
        low[axis] = Math.min(low[axis]!, this.place[axis]!);
        high[axis] = Math.max(high[axis]!, this.place[axis]!);
      }
    }
    if (!(low[0]! <= high[0]!)) return false;
    low[2] = Math.min(0, low[2]!);
    for (let axis = 0; axis < 3; axis++) out[axis] = (low[axis]! + high[axis]!) / 2;
    out[3] = Math.hypot(high[0]! - low[0]!, high[1]! - low[1]!, high[2]! - low[2]!) / 2;
    return true;
  }

  frame(chosen: Body | null): void {
    const { world, links, dots, marks, spots, faces, trails } = this;
    if (world.version !== this.version) this.rebuild();
    links.begin();
    dots.begin();
    marks.begin();
    spots.begin();
    faces.begin();
    trails.begin();
    this.crowded = this.stage.width < NARROW_PX && this.named > CROWD;
    for (let k = 0; k < world.bodies.length; k++) this.body(world.bodies[k]!, this.forms[k]!, world.bodies[k] === chosen);
    for (let k = 0; k < world.markerCount; k++) dots.add(world.markers_m, k, SINGLE, this.markerTint, Round.Ball);
    links.finish();
    dots.finish();
    marks.finish();
    spots.finish();
    faces.finish();
    trails.finish();
  }

  private body(body: Body, form: Form, chosen: boolean): void {
    const look = this.looks[body.source]!;
    const { rgba, pattern } = look;
    this.placeOf(body, this.place);
    const px = this.place[0]!;
    const py = this.place[1]!;
    const pz = this.place[2]!;
    const q = body.world_from_body;
    const w = q[0]!;
    const x = q[1]!;
    const y = q[2]!;
    const z = q[3]!;
    const r00 = 1 - 2 * (y * y + z * z);
    const r01 = 2 * (x * y - w * z);
    const r02 = 2 * (x * z + w * y);
    const r10 = 2 * (x * y + w * z);
    const r11 = 1 - 2 * (x * x + z * z);
    const r12 = 2 * (y * z - w * x);
    const r20 = 2 * (x * z - w * y);
    const r21 = 2 * (y * z + w * x);
    const r22 = 1 - 2 * (x * x + y * y);
    const { local, world, points, edges, faces } = form;
    for (let k = 0; k < local.length; k += 3) {
      const a = local[k]!;
      const b = local[k + 1]!;
      const c = local[k + 2]!;
      world[k] = px + r00 * a + r01 * b + r02 * c;
      world[k + 1] = py + r10 * a + r11 * b + r12 * c;
      world[k + 2] = pz + r20 * a + r21 * b + r22 * c;
    }
    const foot = points + 4;
    world[3 * foot] = px;
    world[3 * foot + 1] = py;
    world[3 * foot + 2] = 0.001;

    const vanished = body.source === Source.None;
    if (form.balls) for (let k = 0; k < points; k++) this.dots.add(world, k, MARKER, rgba, Round.Ball);
    const edge = chosen ? EDGE_CHOSEN : EDGE;
    for (let k = 0; k < edges.length; k += 2) this.links.add(world, edges[k]!, edges[k + 1]!, edge, rgba, pattern);
    const inside = body.source === Source.Optical ? INSIDE_SEEN : INSIDE;
    for (let k = 0; k < faces.length; k += 3) this.faces.add(world, faces[k]!, faces[k + 1]!, faces[k + 2]!, rgba, inside);

    const bone = body.what.kind === "bone";
    if (bone) {
      this.dots.add(world, points, JOINT, rgba, Round.Ball);
      const { parent } = body;
      if (parent && parent.somewhere && body.somewhere) {
        const from = points + 5;
        for (let axis = 0; axis < 3; axis++) world[3 * from + axis] = parent.position_m[axis]!;
        this.links.add(world, from, points, BONE, rgba, pattern);
      }
    }
    if (!bone || chosen) {
      const thick = vanished ? AXIS_FAINT : AXIS;
      for (let axis = 0; axis < 3; axis++) this.links.add(world, points, points + 1 + axis, thick, AXES[axis]!, Pattern.Solid);
    }
    if (!bone) {
      this.size[0] = 0.09 + 0.05 * Math.max(0, Math.min(2, pz));
      this.size[1] = vanished ? 0.17 : 0.28;
      this.spots.add(world, foot, this.size, this.shade, Round.Spot);
      this.links.add(world, foot, points, chosen ? DROP_CHOSEN : DROP, this.drop, Pattern.Solid);
      if (this.settings.trails && body.what.kind === "body") this.trails.add(body, this.looks);
    }
    if (vanished && (!bone || body.parent === null)) this.marks.add(world, points, CROSS, rgba, Round.Cross);
    if (body.source === Source.Bridged && body.sigma_mm > 0 && !bone) {
      this.size[0] = Math.min(0.6, 0.002 * body.sigma_mm);
      this.size[1] = 1;
      this.marks.add(world, points, this.size, rgba, Round.Halo);
    }
    if (chosen) this.marks.add(world, points, form.ring, rgba, Round.Ring);

    const { label } = form;
    if (!label) return;
    label.sprite.visible = (this.settings.labels && !this.crowded) || chosen;
    label.sprite.position.set(px, py, pz + (bone ? 0.12 : 0.05));
    if (form.shownSource !== body.source) {
      form.shownSource = body.source;
      label.paint(bone ? (body.what.skeleton ?? body.what.name) : body.what.name, body.source, look, this.theme, chosen);
    }
  }
}
