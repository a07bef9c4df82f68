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

const MARKER_M = 0.008;
const EDGE_M = 0.003;
const AXIS_M = 0.0042;
const JOINT_M = 0.02;
/** A node's box, and that of a body without markers: half sizes, m. */
const NODE_BOX = [0.03, 0.02, 0.008] as const;
const PLAIN_BOX = [0.06, 0.04, 0.02] as const;
/** Where bodies stand that have no position: in a row. */
const ROW = { x: -1.6, y: -1.2, step: 0.4, z: 1 } as const;

const AXES = [new Float32Array([0.88, 0.27, 0.25, 1]), new Float32Array([0.2, 0.66, 0.32, 1]), new Float32Array([0.25, 0.45, 0.95, 1])] as const;

/** What the scene says of a body's shape, made once. */
interface Form {
  /** Corners or markers in the body's frame, and in the world. */
  local: Float32Array;
  world: Float32Array;
  edges: Uint16Array;
  faces: Uint16Array;
  axis: number;
  /** Real markers are shown as balls, corners of a box are not. */
  balls: boolean;
  label: Label | null;
  shownSource: number;
}

const box = ([x, y, z]: readonly [number, number, number]): Point[] =>
  [-1, 1].flatMap((a) => [-1, 1].flatMap((b) => [-1, 1].map((c): Point => [a * x, b * y, c * z])));

export class Picture {
  private readonly links = new Links(12000);
  private readonly dots = new Dots(12000, true, 3);
  private readonly marks = new Dots(3000, false, 4);
  private readonly spots = new Dots(1000, false, 1);
  private readonly faces = new Faces(8000);
  private readonly trails = new Trails(100);
  private readonly ground = new Ground();
  private forms: Form[] = [];
  private looks: readonly Look[] = [];
  private theme: Theme = "light";
  private readonly markerTint = new Float32Array([0.5, 0.5, 0.5, 1]);
  private readonly shade = new Float32Array([0, 0, 0, 1]);
  private readonly drop = new Float32Array([0.5, 0.5, 0.5, 1]);
  private version = -1;
  private readonly place = new Float64Array(3);

  constructor(private readonly stage: Stage, private readonly world: World, private readonly settings: Settings) {
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
      return {
        local: new Float32Array(points.flat()),
        world: new Float32Array(3 * points.length),
        edges: new Uint16Array(shape.edges),
        faces: new Uint16Array(shape.faces),
        axis: what.kind === "bone" ? 0.05 : Math.min(0.16, Math.max(0.07, 0.9 * size)),
        balls: own,
        label,
        shownSource: -1,
      };
    });
  }

  /** Where a body is drawn: its place, or one in the row of those that have none. */
  placeOf(body: Body, out: Float64Array): void {
    if (body.placed) {
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
    for (let k = 0; k < world.bodies.length; k++) this.body(world.bodies[k]!, this.forms[k]!, world.bodies[k] === chosen);
    const m = world.markers_m;
    for (let k = 0; k < world.markerCount; k++) dots.add(m[3 * k]!, m[3 * k + 1]!, m[3 * k + 2]!, 0.8 * MARKER_M, this.markerTint, 1, Round.Ball);
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
    const faint = body.source === Source.None ? 0.6 : 1;

    const { local, world: corner, edges, faces } = form;
    for (let k = 0; k < local.length; k += 3) {
      const a = local[k]!;
      const b = local[k + 1]!;
      const c = local[k + 2]!;
      corner[k] = px + r00 * a + r01 * b + r02 * c;
      corner[k + 1] = py + r10 * a + r11 * b + r12 * c;
      corner[k + 2] = pz + r20 * a + r21 * b + r22 * c;
      if (form.balls) this.dots.add(corner[k]!, corner[k + 1]!, corner[k + 2]!, MARKER_M, rgba, 1, Round.Ball);
    }
    const edge = chosen ? 1.5 * EDGE_M : EDGE_M;
    for (let k = 0; k < edges.length; k += 2) {
      const a = 3 * edges[k]!;
      const b = 3 * edges[k + 1]!;
      this.links.add(corner[a]!, corner[a + 1]!, corner[a + 2]!, edge, corner[b]!, corner[b + 1]!, corner[b + 2]!, edge, rgba, 1, pattern);
    }
    const inside = body.source === Source.Optical ? 0.09 : 0.05;
    for (let k = 0; k < faces.length; k += 3) this.faces.add(corner, faces[k]!, faces[k + 1]!, faces[k + 2]!, rgba, inside);

    const bone = body.what.kind === "bone";
    if (bone) {
      this.dots.add(px, py, pz, JOINT_M, rgba, 1, Round.Ball);
      const parent = body.parent;
      if (parent && parent.placed && body.placed) {
        const from = parent.position_m;
        this.links.add(from[0]!, from[1]!, from[2]!, 0.9 * JOINT_M, px, py, pz, 0.45 * JOINT_M, rgba, 0.92, pattern);
      }
    }
    if (!bone || chosen) {
      const axis = form.axis;
      this.links.add(px, py, pz, AXIS_M, px + r00 * axis, py + r10 * axis, pz + r20 * axis, AXIS_M, AXES[0], faint, Pattern.Solid);
      this.links.add(px, py, pz, AXIS_M, px + r01 * axis, py + r11 * axis, pz + r21 * axis, AXIS_M, AXES[1], faint, Pattern.Solid);
      this.links.add(px, py, pz, AXIS_M, px + r02 * axis, py + r12 * axis, pz + r22 * axis, AXIS_M, AXES[2], faint, Pattern.Solid);
    }
    if (!bone) {
      this.spots.add(px, py, 0.001, 0.09 + 0.05 * Math.max(0, Math.min(2, pz)), this.shade, 0.28 * faint, Round.Spot);
      if (pz > 0.02) this.links.add(px, py, 0, 0.0008, px, py, pz, 0.0008, this.drop, chosen ? 0.5 : 0.16, Pattern.Solid);
      if (this.settings.trails && body.what.kind === "body") this.trails.add(body, this.looks);
    }
    if (body.source === Source.None && (!bone || body.parent === null)) this.marks.add(px, py, pz, 0.035, rgba, 2, Round.Cross);
    if (body.source === Source.Bridged && body.sigma_mm > 0 && !bone) this.marks.add(px, py, pz, Math.min(0.6, 0.002 * body.sigma_mm), rgba, 1, Round.Halo);
    if (chosen) this.marks.add(px, py, pz, bone ? 1.6 * JOINT_M : 1.15 * form.axis, rgba, 1, Round.Ring);

    const { label } = form;
    if (!label) return;
    label.sprite.visible = this.settings.labels || chosen;
    label.sprite.position.set(px, py, pz + (bone ? 0.12 : 0.05));
    if (form.shownSource !== body.source) {
      form.shownSource = body.source;
      label.paint(bone ? (body.what.skeleton ?? body.what.name) : body.what.name, body.source, look, this.theme, chosen);
    }
  }
}
