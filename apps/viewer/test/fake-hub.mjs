// A stand-in for the hub: speaks protocol 1 and serves the page as the hub does, so that the page can be worked on and
// tested without a build of the hub.
//
//   node test/fake-hub.mjs [PORT] [BODIES]
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { WebSocketServer } from "ws";

const ASSETS = join(dirname(fileURLToPath(import.meta.url)), "../../../crates/shisei-hub/assets/viewer");
export const CSP = "default-src 'self'; connect-src 'self' ws: wss:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const TYPES = { html: "text/html; charset=utf-8", js: "text/javascript; charset=utf-8", css: "text/css; charset=utf-8", svg: "image/svg+xml" };

/** Joints of a standing person: name, parent, x, y, z. */
const BONES = [
  ["Hips", null, 0, 0, 0.95], ["Spine", 0, 0, 0, 1.15], ["Chest", 1, 0, 0, 1.35], ["Neck", 2, 0, 0, 1.52], ["Head", 3, 0, 0, 1.68],
  ["LShoulder", 2, 0, 0.17, 1.46], ["LElbow", 5, 0, 0.22, 1.2], ["LHand", 6, 0.05, 0.24, 0.96],
  ["RShoulder", 2, 0, -0.17, 1.46], ["RElbow", 8, 0, -0.22, 1.2], ["RHand", 9, 0.05, -0.24, 0.96],
  ["LHip", 0, 0, 0.1, 0.92], ["LKnee", 11, 0.02, 0.1, 0.5], ["LFoot", 12, 0, 0.1, 0.08],
  ["RHip", 0, 0, -0.1, 0.92], ["RKnee", 14, 0.02, -0.1, 0.5], ["RFoot", 15, 0, -0.1, 0.08],
];

const product = ([aw, ax, ay, az], [bw, bx, by, bz]) => [
  aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by,
  aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw,
];
const about = (axis, angle) => [Math.cos(angle / 2), ...[0, 1, 2].map((k) => (k === axis ? Math.sin(angle / 2) : 0))];

export class FakeHub {
  constructor({ bodies = 3, occlusion_s = 5, gap_s = 1.5 } = {}) {
    this.count = bodies;
    this.occlusion_s = occlusion_s;
    this.gap_s = gap_s;
    this.requests = [];
    this.recording = null;
    this.names = ["Node A", "Node B", "Node C", "Wrist"];
    this.paused = false;
    this.headings = new Map();
    this.started = performance.now();
    this.server = createServer((request, response) => this.serve(request, response));
    this.sockets = new WebSocketServer({ noServer: true, maxPayload: 4096 });
    this.server.on("upgrade", (request, socket, head) => {
      if (new URL(request.url, "http://x").pathname !== "/stream") return socket.destroy();
      this.sockets.handleUpgrade(request, socket, head, (client) => this.welcome(client));
    });
  }

  async listen(port = 0) {
    await new Promise((done) => this.server.listen(port, "127.0.0.1", done));
    this.timers = [setInterval(() => this.tick(), 1000 / 60), setInterval(() => this.broadcast(this.status()), 1000)];
    return `http://127.0.0.1:${this.server.address().port}/`;
  }

  async close() {
    for (const timer of this.timers) clearInterval(timer);
    for (const client of this.sockets.clients) client.terminate();
    await new Promise((done) => this.server.close(done));
  }

  serve(request, response) {
    const path = new URL(request.url, "http://x").pathname;
    const name = path === "/" ? "index.html" : path.slice(1);
    response.setHeader("Content-Security-Policy", CSP);
    if (!/^[\w.]+$/.test(name) || !Object.hasOwn(TYPES, name.split(".").pop())) return response.writeHead(404).end();
    try {
      const body = readFileSync(join(ASSETS, name));
      response.writeHead(200, { "Content-Type": TYPES[name.split(".").pop()] }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  }

  welcome(client) {
    client.send(JSON.stringify({ type: "hello", protocol: 1, version: "0.0.0", lang: "en", demo: true, may: ["record", "align", "heading", "name"] }));
    client.send(JSON.stringify(this.scene()));
    client.send(JSON.stringify(this.status()));
    client.on("message", (data) => {
      try {
        this.asked(JSON.parse(String(data)));
      } catch {
        client.close();
      }
    });
  }

  asked(request) {
    this.requests.push(request);
    const note = (en, ja) => this.broadcast({ type: "note", level: "info", en, ja });
    if (request.type === "record" && request.on && !this.recording) {
      this.recording = { file: "take-001.mcap", started: performance.now() };
      note("Recording to take-001.mcap", "take-001.mcap に記録しています");
    } else if (request.type === "record" && !request.on && this.recording) {
      this.recording = null;
      note("Saved take-001.mcap", "take-001.mcap を保存しました");
    } else if (request.type === "name") {
      this.names = this.names.map((name) => (name === request.node ? request.name : name));
      this.broadcast(this.scene());
    } else if (request.type === "align" || request.type === "heading") {
      this.headings.set(request.body, { deg: request.deg ?? 0, at: this.time() });
      note("Attitude set", "姿勢を設定しました");
    }
    this.broadcast(this.status());
  }

  time() {
    return (performance.now() - this.started) / 1000;
  }

  scene() {
    const bodies = [];
    for (let k = 0; k < this.count; k++) {
      const markers = [[0.09, 0, 0], [-0.05, 0.06, 0], [-0.05, -0.07, 0.01], [0, 0.01, 0.07], [0.02, -0.05, -0.03]].slice(0, 4 + (k % 2));
      bodies.push({ id: k + 1, name: `Tool ${k + 1}`, kind: "body", skeleton: null, parent: null, node: this.names[k] ?? null, markers });
    }
    BONES.forEach(([name, parent], k) => bodies.push({ id: 100 + k, name, kind: "bone", skeleton: "Alice", parent: parent === null ? null : 100 + parent, node: null, markers: [] }));
    bodies.push({ id: 200, name: this.names[3], kind: "node", skeleton: null, parent: null, node: this.names[3], markers: [] });
    return { type: "scene", bodies };
  }

  /** Who carries body k at a time: hidden once in a while, the second one for longer than a sensor can carry. */
  sourceOf(k, t) {
    const phase = (t + 1.7 * k) % this.occlusion_s;
    const gap_s = phase - (this.occlusion_s - this.gap_s);
    if (gap_s < 0) return [1, 0];
    return k % 5 === 2 && gap_s > 0.5 * this.gap_s ? [0, gap_s] : [2, gap_s];
  }

  poses() {
    const t = this.time();
    const rows = [];
    for (let k = 0; k < this.count; k++) {
      const ring = 0.9 + 0.55 * Math.floor(k / 8);
      const angle = (2 * Math.PI * k) / Math.min(this.count, 8) + 0.25 * t * (k % 2 ? 1 : -1);
      const [source, gap_s] = this.sourceOf(k, t);
      const q = product(product(about(2, angle + 0.4 * Math.sin(t + k)), about(1, 0.5 * Math.sin(0.7 * t + k))), about(0, 0.4 * Math.sin(1.1 * t)));
      rows.push([k + 1, ring * Math.cos(angle), ring * Math.sin(angle), 1 + 0.25 * Math.sin(0.8 * t + 2 * k), ...q, source, gap_s, 0.15 + 1.2 * gap_s, 0.3 + 40 * gap_s * gap_s]);
    }
    const walk = [0.35 * Math.cos(0.3 * t), 0.35 * Math.sin(0.3 * t)];
    BONES.forEach(([, , x, y, z], k) => {
      const swing = 0.12 * Math.sin(2.2 * t) * Math.sign(y) * (k === 7 || k === 10 ? -1 : k === 13 || k === 16 ? 1.4 : k === 12 || k === 15 ? 0.6 : 0);
      const heading = 0.3 * t + Math.PI / 2;
      const [px, py] = [x + swing, y];
      const hand = k === 7 && (t % 9) > 7.2;
      rows.push([100 + k, walk[0] + px * Math.cos(heading) - py * Math.sin(heading), walk[1] + px * Math.sin(heading) + py * Math.cos(heading), z + 0.015 * Math.sin(4.4 * t), ...about(2, heading), hand ? 2 : 1, hand ? (t % 9) - 7.2 : 0, 0.4, 0.5]);
    });
    const set = this.headings.get(200);
    const yaw = set ? (set.deg * Math.PI) / 180 + 0.2 * (t - set.at) : 0.2 * t;
    rows.push([200, null, null, null, ...product(about(2, yaw), about(1, 0.3 * Math.sin(t))), 3, t, 0.8 + 0.01 * (t % 60), null]);
    const markers = [0, 1, 2, 3].map((k) => [1.6 * Math.cos(1.3 * k + 0.1 * t), 1.6 * Math.sin(1.3 * k + 0.1 * t), 0.3 + 0.4 * k]);
    return { type: "poses", time_s: t, frame: Math.floor(240 * t), poses: rows, markers };
  }

  status() {
    const t = this.time();
    const recording = this.recording && { file: this.recording.file, seconds: (performance.now() - this.recording.started) / 1000, bytes: Math.round(80000 * ((performance.now() - this.recording.started) / 1000)) };
    return {
      type: "status", uptime_s: t,
      inputs: [
        { name: "/dev/ttyACM0", kind: "serial", state: "connected", rate_hz: 480.2, lost: 3, bad: 0 },
        { name: "192.168.1.20", kind: "natnet", state: t % 40 > 30 ? "waiting" : "connected", rate_hz: 240, lost: 0, bad: 0 },
      ],
      nodes: this.names.map((name, k) => ({ name, battery_v: k === 2 ? 3.42 : 3.98 - 0.05 * k, temperature_c: 31.2 + k, rate_hz: 119.9 + 0.1 * k, lost: k, clock_error_us: 6 + 3 * k, last_s: 0.01 })),
      sync: { frames: Math.floor(240 * t), pulse_rate_hz: 240 },
      latency_ms: { median: 1.2, p99: 4.1 },
      outputs: [{ name: "natnet", clients: 1 }, { name: "osc", clients: 0 }],
      clients: this.sockets.clients.size,
      recording,
    };
  }

  tick() {
    if (this.sockets.clients.size > 0) this.broadcast(this.poses());
  }

  broadcast(message) {
    this.raw(JSON.stringify(message));
  }

  /** Any text to every client, nonsense too. */
  raw(text) {
    if (this.paused) return;
    for (const client of this.sockets.clients) if (client.readyState === 1 && client.bufferedAmount < 1e6) client.send(text);
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const hub = new FakeHub({ bodies: Number(process.argv[3] ?? 3) });
  console.log(await hub.listen(Number(process.argv[2] ?? 8080)));
}
