// All lines of the picture in one draw call: round bars between two points, tapered, drawn through, dashed or dotted.
// A frame writes numbers into arrays that are there already.

import * as THREE from "three";
import type { Pattern } from "../source";
import { Column, Parts } from "./column";

const VERTEX = /* glsl */ `
attribute vec4 start; attribute vec4 end; attribute vec4 tint; attribute float pattern;
uniform float pixel;
varying vec4 vTint; varying float vAlong; varying float vLength; varying float vPattern; varying float vShade;
void main() {
  vec3 way = end.xyz - start.xyz;
  float reach = max(length(way), 1e-6);
  vec3 ahead = way / reach;
  vec3 side = normalize(abs(ahead.z) < 0.9 ? cross(ahead, vec3(0., 0., 1.)) : cross(ahead, vec3(1., 0., 0.)));
  vec3 other = cross(ahead, side);
  vec3 along = start.xyz + way * position.z;
  float depth = -(viewMatrix * vec4(along, 1.)).z;
  float radius = max(mix(start.w, end.w, position.z), 0.55 * pixel * max(depth, 0.01));
  vec3 outward = side * position.x + other * position.y;
  vec3 seen = normalize((viewMatrix * vec4(outward, 0.)).xyz);
  vShade = 0.74 + 0.26 * clamp(dot(seen, normalize(vec3(-0.3, 0.7, 0.65))), -1., 1.);
  vTint = tint; vAlong = reach * position.z; vLength = reach; vPattern = pattern;
  gl_Position = projectionMatrix * viewMatrix * vec4(along + outward * radius, 1.);
}`;

const FRAGMENT = /* glsl */ `
varying vec4 vTint; varying float vAlong; varying float vLength; varying float vPattern; varying float vShade;
void main() {
  if (vPattern > 0.5) {
    float wanted = vPattern < 1.5 ? 0.05 : 0.024;
    float period = vLength / max(1., floor(vLength / wanted + 0.5));
    float at = fract(vAlong / period + 0.25);
    if (at > (vPattern < 1.5 ? 0.58 : 0.42)) discard;
  }
  gl_FragColor = vec4(vTint.rgb * vShade, vTint.a);
}`;

export class Links {
  readonly mesh: THREE.Mesh;
  private readonly start: Column;
  private readonly end: Column;
  private readonly tint: Column;
  private readonly pattern: Column;
  private readonly parts: Parts;
  private readonly material: THREE.ShaderMaterial;
  private count = 0;

  /** Room for `most` bars of so many sides. */
  constructor(private readonly most: number, sides: number, instanced: boolean) {
    const bar = new THREE.CylinderGeometry(1, 1, 1, sides, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    this.parts = new Parts(bar, most, instanced);
    const { geometry, corners } = this.parts;
    this.start = new Column(geometry, "start", 4, most, corners);
    this.end = new Column(geometry, "end", 4, most, corners);
    this.tint = new Column(geometry, "tint", 4, most, corners);
    this.pattern = new Column(geometry, "pattern", 1, most, corners);
    this.material = new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, uniforms: { pixel: { value: 0.001 } } });
    this.mesh = new THREE.Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2;
  }

  /** Width of a pixel at a distance of 1 m. */
  setPixel(pixel: number): void {
    this.material.uniforms["pixel"]!.value = pixel;
  }

  begin(): void {
    this.count = 0;
  }

  /**
   * A bar between places `a` and `b` of an array of world coordinates. `bar`: radius at either end, how solid. Arrays
   * and whole numbers only: other numbers would be boxed by every call.
   */
  add(points: Float32Array, a: number, b: number, bar: Float32Array, rgba: Float32Array, pattern: Pattern): void {
    if (this.count >= this.most) return;
    const k = this.count++;
    const s = this.start.array;
    const e = this.end.array;
    const t = this.tint.array;
    for (let axis = 0; axis < 3; axis++) {
      s[4 * k + axis] = points[3 * a + axis]!;
      e[4 * k + axis] = points[3 * b + axis]!;
      t[4 * k + axis] = rgba[axis]!;
    }
    s[4 * k + 3] = bar[0]!;
    e[4 * k + 3] = bar[1]!;
    t[4 * k + 3] = rgba[3]! * bar[2]!;
    this.pattern.array[k] = pattern;
  }

  finish(): void {
    this.parts.show(this.count);
    this.start.upload(this.count);
    this.end.upload(this.count);
    this.tint.upload(this.count);
    this.pattern.upload(this.count);
  }
}
