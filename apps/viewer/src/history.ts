// The last seconds of one body, for graphs and trails: rings of numbers that never grow.

import { unwrapped } from "./angles";

/** 20 s at 60 a second. */
export const KEPT = 1200;

export class History {
  readonly time_s = new Float64Array(KEPT);
  /** Unwrapped, degrees; one ring each for yaw, pitch, roll. */
  readonly angles_deg: readonly [Float64Array, Float64Array, Float64Array] = [new Float64Array(KEPT), new Float64Array(KEPT), new Float64Array(KEPT)];
  readonly sigma_deg = new Float64Array(KEPT);
  readonly source = new Uint8Array(KEPT);
  /** x, y, z of every moment, m; NaN where unknown. */
  readonly position_m = new Float32Array(KEPT * 3);
  /** Moments held. */
  count = 0;
  /** Where the next one goes. */
  next = 0;

  add(time_s: number, angles_deg: Float64Array, sigma_deg: number, source: number, x: number, y: number, z: number): void {
    const last = this.at(0);
    // A replay that jumped back, or a new demo: what was before has another clock.
    if (last >= 0 && time_s < (this.time_s[last] ?? 0)) this.clear();
    const k = this.next;
    this.time_s[k] = time_s;
    for (let axis = 0; axis < 3; axis++) {
      const ring = this.angles_deg[axis];
      const now = angles_deg[axis] ?? NaN;
      if (ring) ring[k] = axis === 1 ? now : unwrapped(this.count > 0 ? (ring[last] ?? NaN) : NaN, now);
    }
    this.sigma_deg[k] = sigma_deg;
    this.source[k] = source;
    this.position_m[3 * k] = x;
    this.position_m[3 * k + 1] = y;
    this.position_m[3 * k + 2] = z;
    this.next = (k + 1) % KEPT;
    if (this.count < KEPT) this.count++;
  }

  /** Place in the rings of the moment that came `back` moments before the newest; −1 when it is not held. */
  at(back: number): number {
    return back < this.count ? (this.next - 1 - back + 2 * KEPT) % KEPT : -1;
  }

  clear(): void {
    this.count = 0;
    this.next = 0;
  }
}
