// Faint sides between a body's markers, all bodies in one mesh.

import * as THREE from "three";
import { Column } from "./column";

export class Faces {
  readonly mesh: THREE.Mesh;
  private readonly geometry = new THREE.BufferGeometry();
  private readonly place: Column;
  private readonly tint: Column;
  private count = 0;

  constructor(private readonly most: number) {
    this.place = new Column(this.geometry, "position", 3, 3 * most, 1);
    this.tint = new Column(this.geometry, "tint", 4, 3 * most, 1);
    const material = new THREE.ShaderMaterial({
      vertexShader: "attribute vec4 tint; varying vec4 vTint; void main() { vTint = tint; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.); }",
      fragmentShader: "varying vec4 vTint; void main() { gl_FragColor = vTint; }",
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
    });
    this.mesh = new THREE.Mesh(this.geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 1;
  }

  begin(): void {
    this.count = 0;
  }

  /** A triangle of three places in an array of world coordinates. */
  add(points: Float32Array, a: number, b: number, c: number, rgba: Float32Array, solidity: Float32Array): void {
    if (this.count >= this.most) return;
    const k = this.count++;
    const p = this.place.array;
    const t = this.tint.array;
    for (let axis = 0; axis < 3; axis++) {
      p[9 * k + axis] = points[3 * a + axis]!;
      p[9 * k + 3 + axis] = points[3 * b + axis]!;
      p[9 * k + 6 + axis] = points[3 * c + axis]!;
    }
    for (let corner = 0; corner < 3; corner++) {
      t[12 * k + 4 * corner] = rgba[0]!;
      t[12 * k + 4 * corner + 1] = rgba[1]!;
      t[12 * k + 4 * corner + 2] = rgba[2]!;
      t[12 * k + 4 * corner + 3] = rgba[3]! * solidity[0]!;
    }
  }

  finish(): void {
    this.geometry.setDrawRange(0, 3 * this.count);
    this.place.upload(3 * this.count);
    this.tint.upload(3 * this.count);
  }
}
