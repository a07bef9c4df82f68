// The floor: a grid of 0.25 m and 1 m that fades out, x and y through the origin in their colours. Without a graphics
// card it is made of thin lines: a floor whose every pixel is computed costs more than all that stands on it.

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

/** Where the grid ends, m, and where it begins to fade. */
const END_M = 9;
const FADE_M = 2.5;
/** The fine grid of lines ends here, m; farther away it would be a grey area. */
const FINE_M = 3;

export class Ground {
  readonly mesh: THREE.Mesh | THREE.LineSegments;
  private readonly material: THREE.ShaderMaterial;

  constructor(bySoftware: boolean) {
    this.material = new THREE.ShaderMaterial({
      vertexShader: bySoftware ? LINES_VERTEX : "varying vec2 vAt; void main() { vAt = position.xy; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.); }",
      fragmentShader: bySoftware ? LINES_FRAGMENT : FRAGMENT,
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
      uniforms: { ink: { value: new THREE.Vector3(0.2, 0.25, 0.35) }, strength: { value: 0.3 } },
    });
    this.mesh = bySoftware ? new THREE.LineSegments(lines(), this.material) : new THREE.Mesh(new THREE.CircleGeometry(END_M, 48), this.material);
    this.mesh.frustumCulled = false;
  }

  setInk(red: number, green: number, blue: number, strength: number): void {
    (this.material.uniforms["ink"]!.value as THREE.Vector3).set(red, green, blue);
    this.material.uniforms["strength"]!.value = strength;
  }
}

const LINES_VERTEX = /* glsl */ `
attribute vec4 tint;
uniform vec3 ink; uniform float strength;
varying vec4 vTint;
void main() {
  vTint = tint.r < 0. ? vec4(ink, tint.a * strength) : tint;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.);
}`;

const LINES_FRAGMENT = "varying vec4 vTint; void main() { gl_FragColor = vTint; }";

/** The same grid as pieces of lines; a tint below 0 is that of the ink. */
function lines(): THREE.BufferGeometry {
  const places: number[] = [];
  const tints: number[] = [];
  const fade = (x: number, y: number): number => {
    const t = Math.min(1, Math.max(0, (Math.hypot(x, y) - FADE_M) / (END_M - FADE_M)));
    return 1 - t * t * (3 - 2 * t);
  };
  const piece = (from: readonly [number, number], to: readonly [number, number], tint: readonly [number, number, number], solidity: number | null): void => {
    for (const [x, y] of [from, to]) {
      places.push(x, y, 0);
      tints.push(...tint, solidity === null ? 0.9 : solidity * fade(x, y));
    }
  };
  const INK = [-1, -1, -1] as const;
  const grid = (step: number, reach: number, solidity: number, skip: number): void => {
    const count = Math.round(reach / step);
    for (let k = -count; k <= count; k++) {
      if (skip > 0 && k % skip === 0) continue;
      const across = k * step;
      const half = Math.sqrt(Math.max(0, reach * reach - across * across));
      const pieces = Math.max(2, Math.ceil(2 * half));
      for (let j = 0; j < pieces; j++) {
        const a = half * ((2 * j) / pieces - 1);
        const b = half * ((2 * (j + 1)) / pieces - 1);
        piece([across, a], [across, b], INK, solidity);
        piece([a, across], [b, across], INK, solidity);
      }
    }
  };
  grid(0.25, FINE_M, 0.35, 4);
  grid(1, END_M, 1, 0);
  // one line is a pixel wide: two are seen better
  for (const beside of [-0.004, 0.004]) {
    piece([0, beside], [1, beside], [0.86, 0.28, 0.26], null);
    piece([beside, 0], [beside, 1], [0.2, 0.62, 0.3], null);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
  geometry.setAttribute("tint", new THREE.Float32BufferAttribute(tints, 4));
  return geometry;
}
