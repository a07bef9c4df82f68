// The chosen body: what carries it, where it is, how sure that is, its graphs, and what can be set.

import { type Look, lookOf, sign } from "../source";
import type { Ability } from "../protocol";
import { say } from "../text";
import type { Body } from "../world";
import { find, make, mark, put } from "./dom";
import { Graph } from "./graph";
import { stateOf } from "./list";
import { degrees, DASH, fixed, wrapped } from "./numbers";

export interface Deeds {
  align(body: Body): void;
  heading(body: Body, deg: number): void;
  follow(on: boolean): void;
  close(): void;
}

export class Inspector {
  private readonly root = find("#inspector");
  private readonly title = find("h2", this.root);
  private readonly source = find("#source");
  private readonly state = make("b");
  private readonly why = make("span");
  private readonly align = find<HTMLButtonElement>("#align");
  private readonly followButton = find<HTMLButtonElement>("#follow");
  private readonly heading = find<HTMLFormElement>("#heading");
  private readonly graph = new Graph(find<HTMLCanvasElement>("#graph"));
  private body: Body | null = null;
  private shownSource = -1;
  private may: readonly Ability[] = [];

  constructor(deeds: Deeds) {
    this.source.append(sign(0), this.state, this.why);
    find(".close", this.root).addEventListener("click", () => deeds.close());
    this.align.addEventListener("click", () => this.body && deeds.align(this.body));
    this.followButton.addEventListener("click", () => deeds.follow(this.followButton.getAttribute("aria-pressed") !== "true"));
    this.heading.addEventListener("submit", (event) => {
      event.preventDefault();
      const deg = find<HTMLInputElement>("input", this.heading).valueAsNumber;
      if (this.body && Number.isFinite(deg)) deeds.heading(this.body, deg);
    });
  }

  show(body: Body | null): void {
    this.body = body;
    this.root.hidden = body === null;
    document.body.classList.toggle("inspecting", body !== null);
    this.shownSource = -1;
    if (body) this.update();
  }

  setMay(may: readonly Ability[]): void {
    this.may = may;
  }

  setFollow(on: boolean): void {
    mark(this.followButton, "aria-pressed", String(on));
  }

  setTheme(looks: readonly Look[]): void {
    this.graph.setTheme(looks);
  }

  draw(now_s: number): void {
    if (this.body) this.graph.draw(this.body, now_s);
  }

  /** A few times a second. */
  update(): void {
    const { body } = this;
    if (!body) return;
    put(this.title, body.what.skeleton ? `${body.what.skeleton} · ${body.what.name}` : body.what.name);
    if (this.shownSource !== body.source) {
      this.shownSource = body.source;
      this.source.firstElementChild?.replaceWith(sign(body.source));
    }
    put(this.state, stateOf(body));
    put(this.why, say(`${lookOf("light", body.source).name}Help`));
    const p = body.position_m;
    put(find("#position"), body.somewhere ? `${fixed(p[0], 3)}  ${fixed(p[1], 3)}  ${fixed(p[2], 3)} m` : say("unknown"));
    const error = `${Number.isFinite(body.sigma_deg) ? degrees(body.sigma_deg, 2) : DASH} · ${Number.isFinite(body.sigma_mm) ? fixed(body.sigma_mm, 1, " mm") : DASH}`;
    put(find("#uncertainty"), body.source === 0 ? DASH : error);
    const names = ["#yaw", "#pitch", "#roll"];
    for (let axis = 0; axis < 3; axis++) put(find(names[axis]!), degrees(wrapped(body.angles_deg[axis]!)));
    this.align.hidden = !this.may.includes("align");
    this.heading.hidden = !this.may.includes("heading");
    this.align.disabled = !body.settable;
    for (const part of this.heading.querySelectorAll<HTMLInputElement | HTMLButtonElement>("input, button")) part.disabled = !body.settable;
  }
}
