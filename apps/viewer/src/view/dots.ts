// All round things of the picture in one draw call: balls (markers, joints), halos (expected error), crosses
// (vanished) and spots on the ground, as squares that a fragment shader rounds.

import * as THREE from "three";
import { Column, Parts } from "./column";

export const enum Shape {
  Ball = 0,
  /** A dashed circle with a faint inside. */
  Halo = 1,
  Cross = 2,
  /** A soft spot lying on the ground. */
  Spot = 3,
  /** A ring around what is chosen. */
  Ring = 4,
}

const VERTEX = /* glsl */ `
attribute vec4 place; attribute vec4 tint; attribute float shape;
uniform float pixel;
varying vec4 vTint; varying vec2 vAt; varying float vShape; varying float vSoft;
void main() {
  vAt = position.xy; vTint = tint; vShape = shape;
  vec4 centre = viewMatrix * vec4(place.xyz, 1.);
  float one = pixel * max(-centre.z, 0.01);
  float least = shape < 0.5 ? 2.2 * one : (shape > 1.5 && shape < 2.5 ? 6. * one : (shape > 3.5 ? 13. * one : 0.));
  float radius = max(place.w, least);
  vSoft = clamp(1.2 * one / radius, 0.01, 0.5);
  if (shape > 2.5 && shape < 3.5) gl_Position = projectionMatrix * viewMatrix * vec4(place.xyz + vec3(position.xy * radius, 0.), 1.);
  else gl_Position = projectionMatrix * (centre + vec4(position.xy * radius, shape < 0.5 ? 0. : 0.02, 0.));
}`;

const FRAGMENT = /* glsl */ `
varying vec4 vTint; varying vec2 vAt; varying float vShape; varying float vSoft;
void main() {
  float r = length(vAt);
  float edge = 1. - smoothstep(1. - vSoft, 1., r);
  vec4 colour = vTint;
  if (vShape < 0.5) {
    float height = sqrt(max(0., 1. - r * r));
    colour.rgb *= 0.72 + 0.36 * clamp(dot(vec3(vAt, height), normalize(vec3(-0.3, 0.7, 0.65))), -0.6, 1.);
    colour.a *= edge;
  } else if (vShape < 1.5) {
    float ring = smoothstep(1. - 3. * vSoft, 1. - 2. * vSoft, r) * edge;
    float dash = step(0.45, fract(atan(vAt.y, vAt.x) * 3.8197));
    colour.a *= max(0.13 * edge, 0.8 * ring * dash);
  } else if (vShape < 2.5) {
    float arm = min(abs(vAt.x - vAt.y), abs(vAt.x + vAt.y)) * 0.7071;
    colour.a *= (1. - smoothstep(0.14, 0.14 + vSoft, arm)) * edge;
  } else if (vShape < 3.5) {
    colour.a *= 1. - smoothstep(0.1, 1., r);
  } else {
    colour.a *= smoothstep(1. - 3. * vSoft, 1. - 2. * vSoft, r) * edge;
  }
  if (colour.a < 0.01) discard;
  gl_FragColor = colour;
}`;

export class Dots {
  readonly mesh: THREE.Mesh;
  private readonly place: Column;
  private readonly tint: Column;
  private readonly shape: Column;
  private readonly parts: Parts;
  private readonly material: THREE.ShaderMaterial;
  private count = 0;

  constructor(private readonly most: number, solid: boolean, order: number, instanced: boolean) {
    this.parts = new Parts(new THREE.PlaneGeometry(2, 2), most, instanced);
    const { geometry, corners } = this.parts;
    this.place = new Column(geometry, "place", 4, most, corners);
    this.tint = new Column(geometry, "tint", 4, most, corners);
    this.shape = new Column(geometry, "shape", 1, most, corners);
    this.material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: solid,
      uniforms: { pixel: { value: 0.001 } },
    });
    this.mesh = new THREE.Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = order;
  }

  setPixel(pixel: number): void {
    this.material.uniforms["pixel"]!.value = pixel;
  }

  begin(): void {
    this.count = 0;
  }

  /** At place `at` of an array of world coordinates. `size`: radius, how solid. Arrays for the same reason as in links.ts. */
  add(points: Float32Array, at: number, size: Float32Array, rgba: Float32Array, shape: Shape): void {
    if (this.count >= this.most) return;
    const k = this.count++;
    const p = this.place.array;
    const t = this.tint.array;
    for (let axis = 0; axis < 3; axis++) {
      p[4 * k + axis] = points[3 * at + axis]!;
      t[4 * k + axis] = rgba[axis]!;
    }
    p[4 * k + 3] = size[0]!;
    t[4 * k + 3] = rgba[3]! * size[1]!;
    this.shape.array[k] = shape;
  }

  finish(): void {
    this.parts.show(this.count);
    this.place.upload(this.count);
    this.tint.upload(this.count);
    this.shape.upload(this.count);
  }
}
