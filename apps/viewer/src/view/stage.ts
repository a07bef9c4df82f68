// Renderer, camera and what moves it. The scene is z-up as the stream is: no change of frames anywhere.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const FOV_DEG = 38;
const NEAREST_M = 0.15;
const FARTHEST_M = 40;
/** Fewer frames a second than this for a while: fewer pixels. */
const SLOW_MS = 1000 / 48;
const FEWEST = 0.7;

export type View = "top" | "front" | "side" | "corner";

const VIEWS: Record<View, readonly [number, number, number]> = {
  top: [0, -0.001, 1],
  front: [0, -1, 0.25],
  side: [1, 0, 0.25],
  corner: [0.62, -0.78, 0.42],
};

/** True without a graphics card, where every pixel counts. */
function drawnBySoftware(): boolean {
  const probe = document.createElement("canvas").getContext("webgl2");
  if (!probe) return false;
  const info = probe.getExtension("WEBGL_debug_renderer_info");
  const name = String(probe.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : probe.RENDERER));
  probe.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class Stage {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(FOV_DEG, 1, 0.02, 200);
  readonly renderer: THREE.WebGLRenderer;
  readonly controls: OrbitControls;
  /** No graphics card: what is drawn is drawn with less. */
  readonly bySoftware = drawnBySoftware();
  width = 1;
  height = 1;
  /** Size of a CSS pixel at a distance of 1. */
  unit = 0.001;
  private readonly inset = new Float64Array(4);
  private ratio = 1;
  private slow = 0;
  private last_ms = 0;
  private readonly scratch = new THREE.Vector3();
  private readonly spherical = new THREE.Spherical();
  private readonly toYUp: THREE.Quaternion;
  private readonly fromYUp: THREE.Quaternion;
  private readonly resized: () => void;

  constructor(private readonly canvas: HTMLCanvasElement, resized: () => void) {
    this.resized = resized;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.bySoftware, alpha: true, powerPreference: "high-performance" });
    this.renderer.setClearColor(0x000000, 0);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(3, -3.8, 2.6);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0, 0, 0.8);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.15;
    this.controls.minDistance = NEAREST_M;
    this.controls.maxDistance = FARTHEST_M;
    this.toYUp = new THREE.Quaternion().setFromUnitVectors(this.camera.up, new THREE.Vector3(0, 1, 0));
    this.fromYUp = this.toYUp.clone().invert();
    this.ratio = Math.min(2, devicePixelRatio);
    new ResizeObserver(() => this.fit()).observe(canvas);
    this.fit();
  }

  /** Pixels at the edges that panels cover: the middle of the picture is that of the rest. */
  setInsets(left: number, top: number, right: number, bottom: number): void {
    const { inset } = this;
    if (inset[0] === left && inset[1] === top && inset[2] === right && inset[3] === bottom) return;
    inset.set([left, top, right, bottom]);
    this.fit();
  }

  private fit(): void {
    const { clientWidth, clientHeight } = this.canvas;
    this.width = Math.max(1, clientWidth);
    this.height = Math.max(1, clientHeight);
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setSize(this.width, this.height, false);
    this.camera.aspect = this.width / this.height;
    const right = (this.inset[2]! - this.inset[0]!) / 2;
    const down = (this.inset[3]! - this.inset[1]!) / 2;
    this.camera.setViewOffset(this.width, this.height, right, down, this.width, this.height);
    this.unit = (2 * Math.tan((FOV_DEG * Math.PI) / 360)) / this.height;
    this.resized();
  }

  /** Draws; fewer pixels where the machine is too slow for all of them. */
  draw(now_ms: number): void {
    const took = now_ms - this.last_ms;
    this.last_ms = now_ms;
    if (took < 500) this.slow = took > SLOW_MS ? this.slow + 1 : Math.max(0, this.slow - 2);
    if (this.slow > 45 && this.ratio > FEWEST) {
      this.ratio = Math.max(FEWEST, this.ratio * 0.75);
      this.slow = 0;
      this.fit();
    }
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
  }

  /** Looks at a ball of the world from one side; the distance is such that it fills the picture. */
  look(x: number, y: number, z: number, radius: number, view: View | null): void {
    const { target } = this.controls;
    const direction = this.scratch;
    if (view) direction.set(...VIEWS[view]);
    else direction.copy(this.camera.position).sub(target);
    const free = (this.width - this.inset[0]! - this.inset[2]!) / this.height;
    const narrow = Math.min(1, Math.max(0.3, free));
    const distance = (0.82 * Math.max(radius, 0.3)) / Math.sin((FOV_DEG * Math.PI) / 360) / narrow;
    target.set(x, y, z);
    this.camera.position.copy(target).addScaledVector(direction.normalize(), distance);
    this.controls.update();
  }

  /** Brings the middle of the picture nearer to a place, the camera going along. */
  follow(x: number, y: number, z: number): void {
    const { target } = this.controls;
    const step = this.scratch.set(x, y, z).sub(target).multiplyScalar(0.12);
    target.add(step);
    this.camera.position.add(step);
  }

  /** Turns the camera about the middle, rad. */
  turn(left: number, up: number): void {
    const { target } = this.controls;
    const offset = this.scratch.copy(this.camera.position).sub(target).applyQuaternion(this.toYUp);
    this.spherical.setFromVector3(offset);
    this.spherical.theta += left;
    this.spherical.phi = Math.min(Math.PI - 0.02, Math.max(0.02, this.spherical.phi - up));
    offset.setFromSpherical(this.spherical).applyQuaternion(this.fromYUp);
    this.camera.position.copy(target).add(offset);
  }

  /** Moves camera and middle sideways, in parts of the distance. */
  move(right: number, up: number): void {
    const { target } = this.controls;
    const distance = this.camera.position.distanceTo(target);
    for (const [column, part] of [[0, right], [1, up]] as const) {
      this.scratch.setFromMatrixColumn(this.camera.matrix, column).multiplyScalar(part * distance);
      target.add(this.scratch);
      this.camera.position.add(this.scratch);
    }
  }

  zoom(factor: number): void {
    const { target } = this.controls;
    const offset = this.scratch.copy(this.camera.position).sub(target);
    offset.setLength(Math.min(FARTHEST_M, Math.max(NEAREST_M, offset.length() * factor)));
    this.camera.position.copy(target).add(offset);
  }

  /** Where a place is on the canvas, CSS pixels; false behind the camera. */
  project(x: number, y: number, z: number, out: { x: number; y: number }): boolean {
    const at = this.scratch.set(x, y, z).project(this.camera);
    out.x = (0.5 + 0.5 * at.x) * this.width;
    out.y = (0.5 - 0.5 * at.y) * this.height;
    return at.z < 1;
  }
}
