// The list of bodies, skeletons and nodes with what carries each of them.

import { lookOf, sign } from "../source";
import { Source } from "../protocol";
import { say } from "../text";
import type { Body, World } from "../world";
import { button, find, make, mark, put } from "./dom";
import { fixed } from "./numbers";

interface Row {
  body: Body;
  /** For a skeleton: all its bones; the worst is shown. */
  bones: Body[];
  button: HTMLButtonElement;
  state: HTMLElement;
  shown: number;
}

export class List {
  private readonly root = find("#bodies");
  private rows: Row[] = [];
  private version = -1;
  private readonly open = new Set<string>();

  constructor(private readonly world: World, private readonly choose: (body: Body) => void) {}

  /** Builds the rows anew: another scene or language. */
  rebuild(): void {
    this.version = this.world.version;
    this.rows = [];
    this.root.replaceChildren();
    const { bodies } = this.world;
    this.group(say("bodies"), bodies.filter((body) => body.what.kind === "body"));
    const skeletons = new Map<string, Body[]>();
    for (const body of bodies) {
      if (body.what.kind !== "bone") continue;
      const name = body.what.skeleton ?? say("skeletons");
      skeletons.set(name, [...(skeletons.get(name) ?? []), body]);
    }
    if (skeletons.size > 0) this.root.append(make("h2", "", say("skeletons")));
    for (const [name, bones] of skeletons) this.skeleton(name, bones);
    this.group(say("nodes"), bodies.filter((body) => body.what.kind === "node"));
    if (bodies.length === 0) this.root.append(make("p", "", say("noBodies")));
  }

  private group(title: string, bodies: Body[]): void {
    if (bodies.length === 0) return;
    const list = make("ul");
    for (const body of bodies) list.append(this.row(body, body.what.name, []));
    this.root.append(make("h2", "", title), list);
  }

  private skeleton(name: string, bones: Body[]): void {
    const list = make("ul");
    list.append(this.row(bones[0]!, name, bones));
    const inner = make("ul", "bones");
    inner.hidden = !this.open.has(name);
    for (const bone of bones) inner.append(this.row(bone, bone.what.name, []));
    const more = button("", "more", () => {
      inner.hidden = !inner.hidden;
      if (inner.hidden) this.open.delete(name);
      else this.open.add(name);
      show();
    });
    const show = (): void => {
      more.textContent = `${inner.hidden ? "▸" : "▾"} ${bones.length}`;
      more.setAttribute("aria-expanded", String(!inner.hidden));
      more.setAttribute("aria-label", `${name}: ${bones.length}`);
    };
    show();
    const item = make("li");
    item.append(more, inner);
    list.append(item);
    this.root.append(list);
  }

  private row(body: Body, name: string, bones: Body[]): HTMLElement {
    const row = button("", "row", () => this.choose(body));
    const state = make("span");
    row.append(sign(Source.None), make("b", "", name), state);
    row.title = name;
    this.rows.push({ body, bones, button: row, state, shown: -1 });
    const item = make("li");
    item.append(row);
    return item;
  }

  /** A few times a second. */
  update(chosen: Body | null): void {
    if (this.version !== this.world.version) this.rebuild();
    for (const row of this.rows) {
      let worst = row.body;
      for (const bone of row.bones) if (rank(bone.source) > rank(worst.source)) worst = bone;
      if (row.shown !== worst.source) {
        row.shown = worst.source;
        row.button.firstElementChild?.replaceWith(sign(worst.source));
        mark(row.button, "data-source", String(worst.source));
      }
      put(row.state, stateOf(worst));
      mark(row.button, "aria-pressed", String(row.body === chosen));
    }
  }
}

const rank = (source: Source): number => (source === Source.Optical ? 0 : source === Source.Inertial ? 1 : source === Source.Bridged ? 2 : 3);

/** "optical", "bridged 0.4 s". */
export function stateOf(body: Body): string {
  const name = say(lookOf("light", body.source).name);
  const aged = (body.source === Source.Bridged || body.source === Source.None) && body.gap_s > 0;
  return aged ? `${name} ${fixed(body.gap_s, body.gap_s < 10 ? 1 : 0)} s` : name;
}
