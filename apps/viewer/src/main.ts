// Puts the page together: the stream into the world, the world into picture and panels, what is pressed to the hub.

import { Connection, streamAddress } from "./connection";
import { Pace } from "./pace";
import type { Message, Status } from "./protocol";
import { load, remember, remembered, type Theme } from "./settings";
import { lookOf } from "./source";
import { say, setLang } from "./text";
import { Bar } from "./ui/bar";
import { find, mark, translate } from "./ui/dom";
import { Help } from "./ui/help";
import { Inspector } from "./ui/inspector";
import { type Deed, listen } from "./ui/keys";
import { legend } from "./ui/legend";
import { List } from "./ui/list";
import { fixed } from "./ui/numbers";
import { StatusPanel } from "./ui/status";
import { Toasts } from "./ui/toasts";
import { Picture } from "./view/picture";
import { Stage, type View } from "./view/stage";
import { type Body, World } from "./world";

const PANELS_EVERY_MS = 200;
const GRAPH_EVERY_MS = 33;
const TAP_PX = 6;
const REACH_PX = { mouse: 26, touch: 40 } as const;
const SETTLE_MS = 400;

const settings = load(location.search, remembered(), navigator.languages);
const darkWanted = matchMedia("(prefers-color-scheme: dark)");
const world = new World();
const pace = new Pace();
let chosen: Body | null = null;
let following = false;
let framed_ms = -1;
let status: Status | null = null;

const connection = new Connection(streamAddress(location), heard, (link) => {
  if (link === "lost") world.lost();
  bar.setLink(link);
});
const toasts = new Toasts();
const bar = new Bar(connection, notSent);
const list = new List(world, (body) => choose(body === chosen ? null : body));
const help = new Help();
const panel = new StatusPanel(
  (node, name) => connection.send({ type: "name", node, name }) || notSent(),
  () => act("status"),
);
const inspector = new Inspector({
  align: (body) => connection.send({ type: "align", body: body.id }) || notSent(),
  heading: (body, deg) => connection.send({ type: "heading", body: body.id, deg }) || notSent(),
  follow: (on) => follow(on),
  close: () => choose(null),
});

let stage: Stage | null = null;
let picture: Picture | null = null;
try {
  stage = new Stage(find<HTMLCanvasElement>("#stage"), () => picture?.resized());
  picture = new Picture(stage, world, settings);
} catch {
  stage = null;
  find("#no-webgl").hidden = false;
}

function heard(message: Message, now_ms: number): void {
  switch (message.type) {
    case "hello":
      bar.setHello(message);
      inspector.setMay(message.may);
      panel.setMay(message.may);
      break;
    case "scene": {
      const id = chosen?.id ?? null;
      world.change(message);
      if (chosen !== world.body(id)) choose(world.body(id));
      list.rebuild();
      framed_ms = framed_ms < 0 ? now_ms + SETTLE_MS : framed_ms;
      break;
    }
    case "poses":
      world.take(message, now_ms);
      break;
    case "status":
      status = message;
      bar.take(message);
      panel.take(message, paceText());
      break;
    case "note":
      toasts.show(message);
      break;
  }
}

function paceText(): string {
  const { fps } = pace.read();
  return Number.isFinite(fps) ? `${fixed(fps, 0)} Hz` : "–";
}

function notSent(): void {
  toasts.show({ type: "note", level: "warning", en: say("notSent"), ja: say("notSent") });
}

function choose(body: Body | null): void {
  chosen = body;
  if (!body) follow(false);
  inspector.show(body);
  picture?.relabel();
  list.update(chosen);
}

/** The picture's middle is that of the part no panel covers. */
function makeRoom(): void {
  const narrow = innerWidth <= 720;
  const wide = (id: string): number => (find(id).hidden || narrow ? 0 : find(id).offsetWidth + 12);
  const below = find("#status").hidden ? 0 : find("#status").offsetHeight + 12;
  stage?.setInsets(wide("#bodies"), narrow ? 96 : 60, wide("#inspector"), below);
}

function follow(on: boolean): void {
  following = on && chosen !== null;
  inspector.setFollow(following);
}

function theme(): Theme {
  return settings.theme ?? (darkWanted.matches ? "dark" : "light");
}

function showTheme(): void {
  const now = theme();
  document.documentElement.dataset["theme"] = now;
  picture?.setTheme(now);
  inspector.setTheme([0, 1, 2, 3].map((source) => lookOf(now, source)));
}

function showLang(): void {
  setLang(settings.lang);
  document.documentElement.lang = settings.lang;
  translate();
  legend();
  list.rebuild();
  list.update(chosen);
  inspector.update();
  bar.update(performance.now());
  panel.render();
}

function showPanels(): void {
  find("#bodies").hidden = !settings.bodies;
  for (const id of ["#show-bodies"]) mark(find(id), "aria-expanded", String(settings.bodies));
  for (const id of ["#show-status", "#vitals"]) mark(find(id), "aria-expanded", String(settings.status));
  panel.toggle(settings.status);
}

const extent = new Float64Array(4);
function everything(view: View | null): void {
  if (stage && picture?.extent(extent)) stage.look(extent[0]!, extent[1]!, extent[2]!, extent[3]!, view);
}

function step(by: number): void {
  const all = world.bodies.filter((body) => body.what.kind !== "bone" || body.parent === null);
  if (all.length === 0) return;
  const now = chosen ? all.indexOf(chosen) : by > 0 ? -1 : 0;
  choose(all[(now + by + all.length) % all.length] ?? null);
}

function act(deed: Deed): void {
  const TURN = 0.08;
  const deeds: Record<Deed, () => void> = {
    record: () => bar.press() || notSent(),
    next: () => step(1),
    previous: () => step(-1),
    align: () => find<HTMLButtonElement>("#align").click(),
    heading: () => {
      if (chosen?.settable && !find("#heading").hidden) connection.send({ type: "heading", body: chosen.id, deg: 0 }) || notSent();
    },
    follow: () => follow(!following),
    everything: () => everything("corner"),
    top: () => everything("top"),
    front: () => everything("front"),
    side: () => everything("side"),
    left: () => stage?.turn(-TURN, 0),
    right: () => stage?.turn(TURN, 0),
    up: () => stage?.turn(0, TURN),
    down: () => stage?.turn(0, -TURN),
    moveLeft: () => stage?.move(-0.03, 0),
    moveRight: () => stage?.move(0.03, 0),
    moveUp: () => stage?.move(0, 0.03),
    moveDown: () => stage?.move(0, -0.03),
    nearer: () => stage?.zoom(1 / 1.12),
    farther: () => stage?.zoom(1.12),
    trails: () => (settings.trails = !settings.trails),
    labels: () => (settings.labels = !settings.labels),
    bodies: () => (settings.bodies = !settings.bodies),
    status: () => (settings.status = !settings.status),
    lang: () => (settings.lang = settings.lang === "en" ? "ja" : "en"),
    theme: () => (settings.theme = theme() === "dark" ? "light" : "dark"),
    help: () => help.toggle(),
    escape: () => (settings.status && !chosen ? act("status") : choose(null)),
  };
  deeds[deed]();
  if (deed === "bodies" || deed === "status") showPanels();
  if (deed === "lang") showLang();
  if (deed === "theme") showTheme();
  if (["trails", "labels", "bodies", "status", "lang", "theme"].includes(deed)) remember(settings);
}

function pickable(canvas: HTMLCanvasElement): void {
  let x = 0;
  let y = 0;
  let fingers = 0;
  canvas.addEventListener("pointerdown", (event) => {
    fingers = event.isPrimary ? 1 : fingers + 1;
    [x, y] = [event.clientX, event.clientY];
  });
  canvas.addEventListener("pointerup", (event) => {
    if (fingers !== 1 || Math.hypot(event.clientX - x, event.clientY - y) > TAP_PX || event.button !== 0) return;
    const reach = event.pointerType === "mouse" ? REACH_PX.mouse : REACH_PX.touch;
    const { left, top } = canvas.getBoundingClientRect();
    const found = picture?.pick(event.clientX - left, event.clientY - top, reach) ?? null;
    if (found !== chosen) choose(found);
  });
}

let panels_ms = 0;
let graph_ms = 0;
const place = new Float64Array(3);

function frame(now_ms: number): void {
  requestAnimationFrame(frame);
  const began = performance.now();
  if (framed_ms > 0 && began > framed_ms) {
    framed_ms = Infinity;
    everything("corner");
  }
  if (stage && picture) {
    if (following && chosen) {
      picture.placeOf(chosen, place);
      stage.follow(place[0]!, place[1]!, place[2]!);
    }
    picture.frame(chosen);
    stage.draw(now_ms);
  }
  pace.add(now_ms, performance.now() - began);
  if (now_ms - graph_ms > GRAPH_EVERY_MS) {
    graph_ms = now_ms;
    inspector.draw(world.time_s);
  }
  if (now_ms - panels_ms > PANELS_EVERY_MS) {
    panels_ms = now_ms;
    makeRoom();
    connection.watch(began);
    world.expire(began);
    list.update(chosen);
    inspector.update();
    bar.update(began);
  }
}

find("#show-bodies").addEventListener("click", () => act("bodies"));
find("#show-status").addEventListener("click", () => act("status"));
find("#vitals").addEventListener("click", () => act("status"));
find("#language").addEventListener("click", () => act("lang"));
find("#theme").addEventListener("click", () => act("theme"));
find("#show-help").addEventListener("click", () => act("help"));
darkWanted.addEventListener("change", showTheme);
listen(act, () => help.open);
pickable(find<HTMLCanvasElement>("#stage"));
if (matchMedia("(max-width: 720px)").matches) {
  settings.bodies = false;
  settings.status = false;
}
showTheme();
showLang();
showPanels();
connection.open();
requestAnimationFrame(frame);

/** Where a body is on the page, CSS pixels. */
function where(body: Body): { x: number; y: number } {
  const at = { x: NaN, y: NaN };
  picture?.placeOf(body, place);
  stage?.project(place[0]!, place[1]!, place[2]!, at);
  return at;
}

// For tests: what is on the screen, as numbers.
declare global {
  interface Window {
    shisei: { world: World; pace: Pace; status: () => Status | null; where: (body: Body) => { x: number; y: number }; blank: () => void };
  }
}
window.shisei = { world, pace, status: () => status, where, blank: () => stage?.scene.clear() };
document.documentElement.dataset["ready"] = "";
