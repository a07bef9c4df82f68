// The shape between a body's markers: edges and faces of their convex hull. Markers are few, so every triple is tried.

import type { Point } from "./protocol";

export interface Shape {
  /** Pairs of places in the list of points. */
  edges: number[];
  /** Triples of places, seen from outside anticlockwise. */
  faces: number[];
}

/** Beyond this every triple would be too many. */
const MOST = 24;

type V = [number, number, number];
const sub = (a: Point, b: Point): V => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a: V, b: V): V => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a: V, b: V): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export function hull(all: readonly Point[]): Shape {
  const points = all.slice(0, MOST);
  const count = points.length;
  if (count < 2) return { edges: [], faces: [] };
  if (count === 2) return { edges: [0, 1], faces: [] };
  let size = 0;
  for (const p of points) size = Math.max(size, Math.hypot(...sub(p, points[0]!)));
  const flat = 1e-6 * size;
  /** Normals of the faces on either side of an edge. */
  const sides = new Map<number, V[]>();
  const faces: number[] = [];
  for (let i = 0; i < count; i++) {
    for (let j = i + 1; j < count; j++) {
      for (let k = j + 1; k < count; k++) {
        const face = supporting(points, i, j, k, flat);
        if (!face) continue;
        const [normal, outward] = face;
        faces.push(...(outward ? [i, j, k] : [i, k, j]));
        for (const [a, b] of [[i, j], [i, k], [j, k]] as const) {
          const key = a * MOST + b;
          sides.set(key, [...(sides.get(key) ?? []), normal]);
        }
      }
    }
  }
  if (faces.length === 0) return { edges: chain(points), faces: [] };
  const edges: number[] = [];
  for (const [key, normals] of sides) {
    // an edge inside a flat side has that side's normal everywhere
    const first = normals[0]!;
    const corner = normals.some((normal) => dot(normal, first) < 1 - 1e-6);
    if (corner) edges.push(Math.floor(key / MOST), key % MOST);
  }
  return { edges: edges.length ? edges : chain(points), faces };
}

/** The unit normal of the plane of three points, away from all others, if none lies beyond it. */
function supporting(points: readonly Point[], i: number, j: number, k: number, flat: number): [V, boolean] | null {
  const normal = cross(sub(points[j]!, points[i]!), sub(points[k]!, points[i]!));
  const length = Math.hypot(...normal);
  if (length <= flat * flat) return null;
  const unit: V = [normal[0] / length, normal[1] / length, normal[2] / length];
  let above = 0;
  let below = 0;
  for (const point of points) {
    const height = dot(unit, sub(point, points[i]!));
    if (height > flat) above++;
    else if (height < -flat) below++;
  }
  if (above > 0 && below > 0) return null;
  if (above === 0 && below === 0) return null;
  return above === 0 ? [unit, true] : [[-unit[0], -unit[1], -unit[2]], false];
}

/** Points of one plane or line: each joined to its nearest one before it, and the last to the first. */
function chain(points: readonly Point[]): number[] {
  const middle: V = [0, 0, 0];
  for (const p of points) for (let axis = 0; axis < 3; axis++) middle[axis]! += p[axis]! / points.length;
  const first = sub(points[0]!, middle);
  let normal: V = [0, 0, 0];
  for (const p of points) {
    const candidate = cross(first, sub(p, middle));
    if (Math.hypot(...candidate) > Math.hypot(...normal)) normal = candidate;
  }
  const length = Math.hypot(...normal);
  const unit: V = length > 0 ? [normal[0] / length, normal[1] / length, normal[2] / length] : [0, 0, 0];
  const side = cross(unit, first);
  const angle = (p: Point): number => (length > 0 ? Math.atan2(dot(sub(p, middle), side), dot(sub(p, middle), first)) : dot(sub(p, middle), first));
  const order = points.map((_, k) => k).sort((a, b) => angle(points[a]!) - angle(points[b]!));
  const edges: number[] = [];
  for (let k = 1; k < order.length; k++) edges.push(order[k - 1]!, order[k]!);
  if (length > 0 && order.length > 2) edges.push(order[order.length - 1]!, order[0]!);
  return edges;
}
