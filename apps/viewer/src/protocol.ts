// The hub's stream, protocol 1 (docs/en/live.md): what a message is, checked before anything believes it.
// Coordinates: right-handed, z up, metres; quaternions w, x, y, z, world_from_body.

export const PROTOCOL = 1;

/** Where a pose comes from. */
export const enum Source {
  /** Vanished: the pose is the last one and not to be trusted. */
  None = 0,
  Optical = 1,
  Bridged = 2,
  /** Attitude only. */
  Inertial = 3,
}

export type Kind = "body" | "bone" | "node";
export type Ability = "record" | "align" | "heading" | "name";
export type Point = readonly [number, number, number];

export interface Hello {
  type: "hello";
  protocol: number;
  version: string;
  lang: string;
  demo: boolean;
  may: Ability[];
}

export interface SceneBody {
  id: number;
  name: string;
  kind: Kind;
  skeleton: string | null;
  parent: number | null;
  node: string | null;
  /** In the body's own frame, m. */
  markers: Point[];
}

export interface Scene {
  type: "scene";
  bodies: SceneBody[];
}

/** id, px, py, pz, qw, qx, qy, qz, source, gap_s, sigma_deg, sigma_mm. */
export type PoseRow = readonly (number | null)[];
export const POSE_COLUMNS = 12;

export interface Poses {
  type: "poses";
  time_s: number;
  frame: number | null;
  poses: PoseRow[];
  markers: Point[];
}

export interface Input {
  name: string;
  kind: string;
  state: string;
  rate_hz: number | null;
  lost: number | null;
  bad: number | null;
}

export interface NodeStatus {
  name: string;
  battery_v: number | null;
  temperature_c: number | null;
  rate_hz: number | null;
  lost: number | null;
  clock_error_us: number | null;
  last_s: number | null;
}

export interface Status {
  type: "status";
  uptime_s: number | null;
  inputs: Input[];
  nodes: NodeStatus[];
  sync: { frames: number | null; pulse_rate_hz: number | null };
  latency_ms: { median: number | null; p99: number | null };
  outputs: { name: string; clients: number | null }[];
  clients: number | null;
  recording: { file: string; seconds: number; bytes: number } | null;
}

export interface Note {
  type: "note";
  level: "info" | "warning" | "error";
  en: string;
  ja: string;
}

export type Message = Hello | Scene | Poses | Status | Note;

export type Request =
  | { type: "record"; on: boolean }
  | { type: "align"; body: number }
  | { type: "heading"; body: number; deg: number }
  | { type: "name"; node: string; name: string };

/** More than any laboratory has; a message beyond is cut, not believed. */
export const MOST_BODIES = 1000;
export const MOST_MARKERS = 4000;
const MOST_ROWS = 200;
const LONGEST_NAME = 120;

type Fields = Record<string, unknown>;

const fields = (value: unknown): Fields => (typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Fields) : {});
const list = (value: unknown, most: number): unknown[] => (Array.isArray(value) ? (value.length > most ? value.slice(0, most) : value) : []);
const number = (value: unknown): number | null => (typeof value === "number" && Number.isFinite(value) ? value : null);
const text = (value: unknown): string => (typeof value === "string" ? value.slice(0, LONGEST_NAME) : "");
const textOrNull = (value: unknown): string | null => (typeof value === "string" && value !== "" ? text(value) : null);
const isPoint = (value: unknown): value is Point =>
  Array.isArray(value) && value.length === 3 && value.every((v) => typeof v === "number" && Number.isFinite(v) && Math.abs(v) < 1e6);

/** The message of a text, or nothing when it is none of ours. */
export function parse(data: string): Message | null {
  let value: unknown;
  try {
    value = JSON.parse(data);
  } catch {
    return null;
  }
  const from = fields(value);
  switch (from["type"]) {
    case "hello":
      return hello(from);
    case "scene":
      return scene(from);
    case "poses":
      return poses(from);
    case "status":
      return status(from);
    case "note":
      return note(from);
    default:
      return null;
  }
}

function hello(from: Fields): Hello | null {
  const protocol = number(from["protocol"]);
  if (protocol === null) return null;
  const may = list(from["may"], 16).filter((v): v is Ability => v === "record" || v === "align" || v === "heading" || v === "name");
  return { type: "hello", protocol, version: text(from["version"]), lang: text(from["lang"]), demo: from["demo"] === true, may };
}

function scene(from: Fields): Scene {
  const seen = new Set<number>();
  const bodies: SceneBody[] = [];
  for (const entry of list(from["bodies"], MOST_BODIES)) {
    const body = fields(entry);
    const id = number(body["id"]);
    if (id === null || seen.has(id)) continue;
    seen.add(id);
    const kind = body["kind"] === "bone" || body["kind"] === "node" ? body["kind"] : "body";
    bodies.push({
      id,
      name: text(body["name"]) || `#${id}`,
      kind,
      skeleton: textOrNull(body["skeleton"]),
      parent: number(body["parent"]),
      node: textOrNull(body["node"]),
      markers: list(body["markers"], 64).filter(isPoint),
    });
  }
  return { type: "scene", bodies };
}

/** Rows are kept as they come and read by `World.take`, which skips what is no pose: no copy 60 times a second. */
function poses(from: Fields): Poses | null {
  const time_s = number(from["time_s"]);
  if (time_s === null) return null;
  return {
    type: "poses",
    time_s,
    frame: number(from["frame"]),
    poses: list(from["poses"], MOST_BODIES) as PoseRow[],
    markers: list(from["markers"], MOST_MARKERS) as Point[],
  };
}

function status(from: Fields): Status {
  const sync = fields(from["sync"]);
  const latency = fields(from["latency_ms"]);
  const recording = from["recording"] ? fields(from["recording"]) : null;
  return {
    type: "status",
    uptime_s: number(from["uptime_s"]),
    inputs: list(from["inputs"], MOST_ROWS).map(fields).map((input) => ({
      name: text(input["name"]),
      kind: text(input["kind"]),
      state: text(input["state"]),
      rate_hz: number(input["rate_hz"]),
      lost: number(input["lost"]),
      bad: number(input["bad"]),
    })),
    nodes: list(from["nodes"], MOST_ROWS).map(fields).map((node) => ({
      name: text(node["name"]),
      battery_v: number(node["battery_v"]),
      temperature_c: number(node["temperature_c"]),
      rate_hz: number(node["rate_hz"]),
      lost: number(node["lost"]),
      clock_error_us: number(node["clock_error_us"]),
      last_s: number(node["last_s"]),
    })),
    sync: { frames: number(sync["frames"]), pulse_rate_hz: number(sync["pulse_rate_hz"]) },
    latency_ms: { median: number(latency["median"]), p99: number(latency["p99"]) },
    outputs: list(from["outputs"], MOST_ROWS).map(fields).map((output) => ({ name: text(output["name"]), clients: number(output["clients"]) })),
    clients: number(from["clients"]),
    recording: recording && { file: text(recording["file"]), seconds: number(recording["seconds"]) ?? 0, bytes: number(recording["bytes"]) ?? 0 },
  };
}

function note(from: Fields): Note | null {
  const en = typeof from["en"] === "string" ? from["en"].slice(0, 500) : "";
  const ja = typeof from["ja"] === "string" ? from["ja"].slice(0, 500) : "";
  if (!en && !ja) return null;
  const level = from["level"] === "warning" || from["level"] === "error" ? from["level"] : "info";
  return { type: "note", level, en: en || ja, ja: ja || en };
}
