// The floor: a grid of 0.25 m and 1 m that fades out, x and y through the origin in their colours.

import * as THREE from "three";

const FRAGMENT = /* glsl */ `
varying vec2 vAt;
uniform vec3 ink; uniform float strength;
float lines(vec2 at, float step_) {
  vec2 width = fwidth(at / step_);
  vec2 far = abs(fract(at / step_ - 0.5) - 0.5);
  vec2 ink2 = 1. - smoothstep(vec2(0.), width * 1.4, far);
  return max(ink2.x, ink2.y) * (1. - clamp(max(width.x, width.y) * 2.5, 0., 1.));
}
void main() {
  float fade = 1. - smoothstep(2.5, 9., length(vAt));
  float a = max(0.35 * lines(vAt, 0.25), lines(vAt, 1.)) * strength * fade;
  vec3 colour = ink;
  vec2 width = fwidth(vAt) * 1.6;
  if (abs(vAt.y) < width.y && vAt.x > 0. && vAt.x < 1.) { colour = vec3(0.86, 0.28, 0.26); a = 0.9; }
  if (abs(vAt.x) < width.x && vAt.y > 0. && vAt.y < 1.) { colour = vec3(0.2, 0.62, 0.3); a = 0.9; }
  if (a < 0.004) discard;
  gl_FragColor = vec4(colour, a);
}`;

export class Ground {
  readonly mesh: THREE.Mesh;
  private readonly material: THREE.ShaderMaterial;

  constructor() {
    this.material = new THREE.ShaderMaterial({
      vertexShader: "varying vec2 vAt; void main() { vAt = position.xy; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.); }",
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
      uniforms: { ink: { value: new THREE.Vector3(0.2, 0.25, 0.35) }, strength: { value: 0.3 } },
    });
    this.mesh = new THREE.Mesh(new THREE.PlaneGeometry(20, 20), this.material);
    this.mesh.frustumCulled = false;
  }

  setInk(red: number, green: number, blue: number, strength: number): void {
    (this.material.uniforms["ink"]!.value as THREE.Vector3).set(red, green, blue);
    this.material.uniforms["strength"]!.value = strength;
  }
}
