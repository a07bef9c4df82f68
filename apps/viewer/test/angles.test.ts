import assert from "node:assert/strict";
import { test } from "node:test";
import { unwrapped, yawPitchRoll } from "../src/angles";

// Rotation.from_quat([x, y, z, w]).as_euler("ZYX", degrees=True) of SciPy 1.17 on random quaternions w, x, y, z.
const SCIPY: readonly (readonly [number[], number[]])[] = [
  [[-0.4077112819744429, 0.12332846497818092, -0.8411555163753681, 0.3331951343404791], [-143.05367362409734, 37.13623670869349, -123.975311376002]],
  [[0.8617567407147442, -0.34110765814010097, 0.3244330861443134, 0.18911387576207606], [8.289709795929381, 43.486305423957674, -39.8791485714142]],
  [[-0.14884050576040533, -0.3254979264764033, -0.7671473423288221, 0.532336884747219], [155.3740786443008, 35.09363087691461, -118.38134822633744]],
  [[-0.01784566912747596, 0.9450032804808508, 0.3095470288812236, 0.10407194090930529], [36.46254692727031, -11.990224346131356, 178.2013820810668]],
  [[-0.2913366650138346, 0.617064449427534, -0.22435901108813724, 0.695713624284349], [-95.75072192438331, -46.70831484634534, -78.40790635739708]],
  [[-0.14081968340969186, 0.06573423359294953, -0.5382600527967636, 0.8283265919077855], [-162.28207282714772, 2.4470670018418015, -65.65146737330635]],
];

const angles = (w: number, x: number, y: number, z: number): number[] => {
  const out = new Float64Array(3);
  yawPitchRoll(w, x, y, z, out);
  return [...out];
};

test("yaw, pitch and roll are SciPy's", () => {
  for (const [q, expected] of SCIPY) {
    const got = angles(q[0]!, q[1]!, q[2]!, q[3]!);
    for (let axis = 0; axis < 3; axis++) assert(Math.abs(got[axis]! - expected[axis]!) < 1e-9, `${got} and ${expected}`);
  }
});

test("straight up and down, roll is 0 and yaw carries the rest", () => {
  const half = Math.SQRT1_2;
  // turned 30° about z, then nose down 90° about y
  const [c, s] = [Math.cos(Math.PI / 12), Math.sin(Math.PI / 12)];
  for (const side of [1, -1]) {
    const [yaw, pitch, roll] = angles(c * half, -s * half * side, c * half * side, s * half);
    assert(Math.abs(yaw! - 30) < 1e-6 && Math.abs(pitch! - 90 * side) < 1e-6 && roll === 0, `${side}: ${yaw} ${pitch} ${roll}`);
  }
});

test("unwrapped angles take the short way", () => {
  assert.equal(unwrapped(179, -179), 181);
  assert.equal(unwrapped(-721, 10), -710);
  assert.equal(unwrapped(NaN, 10), 10);
});
