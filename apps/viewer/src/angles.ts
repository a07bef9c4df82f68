// Yaw, pitch and roll of a quaternion: Z-Y-X intrinsic, as everywhere in shisei, here in degrees.

const DEG = 180 / Math.PI;

/** Writes yaw, pitch, roll in degrees; `w, x, y, z` of unit length. */
export function yawPitchRoll(w: number, x: number, y: number, z: number, out: Float64Array): void {
  const sine = 2 * (w * y - z * x);
  const pitch = Math.abs(sine) < 1 ? Math.asin(sine) : Math.sign(sine) * (Math.PI / 2);
  if (Math.abs(sine) > 1 - 1e-12) {
    // Straight up or down: roll is 0 and yaw carries the rest.
    out[0] = DEG * Math.atan2(-2 * (x * y - w * z), 1 - 2 * (x * x + z * z));
    out[1] = DEG * pitch;
    out[2] = 0;
    return;
  }
  out[0] = DEG * Math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z));
  out[1] = DEG * pitch;
  out[2] = DEG * Math.atan2(2 * (y * z + w * x), 1 - 2 * (x * x + y * y));
}

/** The angle nearest to `before` that differs from `now` by whole turns. */
export function unwrapped(before: number, now: number): number {
  return Number.isFinite(before) ? now + 360 * Math.round((before - now) / 360) : now;
}
