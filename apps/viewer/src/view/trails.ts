// Where bodies were in the last seconds: one set of line pieces for all of them. Pieces that no camera saw are dashed.

import * as THREE from "three";
import { Column } from "./column";
import type { Body } from "../world";
import type { Look } from "../source";
import { Source } from "../protocol";

/** Moments a trail goes back, and the step between its points. */
const LENGTH = 180;
const STEP = 2;
const PIECES = LENGTH / STEP;
/** A body that jumps farther than this between two points came from elsewhere, m. */
const JUMP_M = 0.6;

export class Trails {
  readonly lines: THREE.LineSegments;
  private readonly geometry = new THREE.BufferGeometry();
  private readonly place: Column;
  private readonly tint: Column;
  private readonly most: number;
  private count = 0;

  constructor(bodies: number) {
    this.most = bodies * PIECES;
    this.place = new Column(this.geometry, "position", 3, 2 * this.most, 1);
    this.tint = new Column(this.geometry, "tint", 4, 2 * this.most, 1);
    const material = new THREE.ShaderMaterial({
      vertexShader: "attribute vec4 tint; varying vec4 vTint; void main() { vTint = tint; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.); }",
      fragmentShader: "varying vec4 vTint; void main() { gl_FragColor = vTint; }",
      transparent: true,
      depthWrite: false,
    });
    this.lines = new THREE.LineSegments(this.geometry, material);
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 1;
  }

  begin(): void {
    this.count = 0;
  }

  add(body: Body, looks: readonly Look[]): void {
    const { history } = body;
    const where = history.position_m;
    // Whole steps of the ring, so that points do not slide along the path.
    const phase = history.next % STEP;
    for (let back = phase; back + STEP < LENGTH; back += STEP) {
      const a = history.at(back);
      const b = history.at(back + STEP);
      if (a < 0 || b < 0 || this.count >= this.most) return;
      const source = history.source[a]!;
      if (source === Source.None || (source !== Source.Optical && Math.floor(b / STEP) % 2 === 0)) continue;
      const far = Math.abs(where[3 * a]! - where[3 * b]!) + Math.abs(where[3 * a + 1]! - where[3 * b + 1]!) + Math.abs(where[3 * a + 2]! - where[3 * b + 2]!);
      if (!(far < JUMP_M)) continue;
      const rgba = looks[source]!.rgba;
      const k = this.count++;
      const p = this.place.array;
      const t = this.tint.array;
      for (let axis = 0; axis < 3; axis++) {
        p[6 * k + axis] = where[3 * a + axis]!;
        p[6 * k + 3 + axis] = where[3 * b + axis]!;
        t[8 * k + axis] = rgba[axis]!;
        t[8 * k + 4 + axis] = rgba[axis]!;
      }
      t[8 * k + 3] = 0.75 * (1 - back / LENGTH);
      t[8 * k + 7] = 0.75 * (1 - (back + STEP) / LENGTH);
    }
  }

  finish(): void {
    this.geometry.setDrawRange(0, 2 * this.count);
    this.place.upload(2 * this.count);
    this.tint.upload(2 * this.count);
  }
}
