// One page of status: inputs, nodes, sync, latency, outputs, recording. Node names are changed here.

import type { Ability, NodeStatus, Status } from "../protocol";
import { type Key, say } from "../text";
import { button, closeButton, find, make } from "./dom";
import { bytes, clock, count, DASH, fixed } from "./numbers";

/** Below this a lithium cell is nearly empty, V. */
const LOW_BATTERY_V = 3.5;
/** A node that was not heard for so long is marked, s. */
const LATE_S = 2;

export class StatusPanel {
  private readonly root = find("#status");
  private status: Status | null = null;
  private renaming: string | null = null;
  private may: readonly Ability[] = [];
  private fps = "";

  /** Between press and release nothing is replaced, or a click would meet nothing. */
  private held = false;

  constructor(private readonly rename: (node: string, name: string) => void, private readonly close: () => void) {
    this.root.addEventListener("pointerdown", () => (this.held = true));
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => setTimeout(() => (this.held = false)));
  }

  setMay(may: readonly Ability[]): void {
    this.may = may;
  }

  take(status: Status, fps: string): void {
    this.status = status;
    this.fps = fps;
    if (!this.held) this.render();
  }

  toggle(on: boolean): void {
    this.root.hidden = !on;
    document.body.classList.toggle("status", on);
    this.renaming = null;
    this.render();
  }

  render(): void {
    // What is being typed is not overwritten.
    if (this.root.hidden || (this.renaming !== null && this.root.querySelector("form:focus-within"))) return;
    const { status } = this;
    const head = make("header");
    const closing = closeButton(() => this.close());
    head.append(make("h2", "", say("status")), closing);
    if (!status) {
      this.root.replaceChildren(head, make("p", "", say("none")));
      return;
    }
    const { sync, latency_ms, recording } = status;
    const facts = make("dl", "facts");
    const fact = (key: Key, value: string, help?: Key): void => {
      const item = make("div");
      if (help) item.title = say(help);
      item.append(make("dt", "", say(key)), make("dd", "", value));
      facts.append(item);
    };
    fact("latency", latency_ms.median === null ? DASH : `${fixed(latency_ms.median, 1)} / ${fixed(latency_ms.p99, 1)} ms`, "latencyHelp");
    fact("sync", sync.frames === null ? DASH : say("pulses", count(sync.frames), fixed(sync.pulse_rate_hz, 1)), "syncHelp");
    fact("recording", recording ? `${recording.file} · ${clock(recording.seconds)} · ${bytes(recording.bytes)}` : say("notRecording"));
    fact("clients", count(status.clients));
    fact("uptime", status.uptime_s === null ? DASH : clock(status.uptime_s));
    fact("fps", this.fps);

    const scroll = this.root.scrollTop;
    const focused = this.root.contains(document.activeElement) && document.activeElement instanceof HTMLElement ? document.activeElement : null;
    const node = focused?.dataset["node"];
    const closes = focused?.classList.contains("close");
    this.root.replaceChildren(head, facts, ...this.inputs(status), ...this.nodes(status.nodes), ...this.outputs(status));
    this.root.scrollTop = scroll;
    // Whoever walks by keyboard stays where they were.
    if (closes) closing.focus();
    if (node !== undefined) for (const change of this.root.querySelectorAll<HTMLElement>(".rename")) if (change.dataset["node"] === node) change.focus();
    const input = this.root.querySelector<HTMLInputElement>("td input");
    input?.focus();
    input?.select();
  }

  private inputs(status: Status): HTMLElement[] {
    if (status.inputs.length === 0) return [];
    const rows = status.inputs.map((input) => {
      const known = input.state === "connected" ? "connected" : input.state === "waiting" ? "waiting" : "stateLost";
      const state = make("span", `state ${known === "stateLost" ? "lost" : known}`, say(known));
      return [`${input.name}${input.kind && input.kind !== input.name ? ` (${input.kind})` : ""}`, state, fixed(input.rate_hz, 1, " Hz"), count(input.lost), count(input.bad)];
    });
    return [make("h3", "", say("inputs")), table(["name", "state", "rate", "lostCount", "bad"], rows)];
  }

  private nodes(nodes: readonly NodeStatus[]): HTMLElement[] {
    if (nodes.length === 0) return [];
    const rows = nodes.map((node) => {
      const battery = make("span", node.battery_v !== null && node.battery_v < LOW_BATTERY_V ? "low" : "", fixed(node.battery_v, 2, " V"));
      const late = make("span", node.last_s !== null && node.last_s > LATE_S ? "low" : "", fixed(node.last_s, 1, " s"));
      return [this.nodeName(node.name), fixed(node.rate_hz, 1, " Hz"), count(node.lost), battery, fixed(node.temperature_c, 1, " °C"), fixed(node.clock_error_us, 0, " µs"), late];
    });
    return [make("h3", "", say("nodes")), table(["name", "rate", "lostCount", "battery", "temperature", "clock", "last"], rows)];
  }

  private outputs(status: Status): HTMLElement[] {
    if (status.outputs.length === 0) return [];
    const rows = status.outputs.map((output) => [output.name, count(output.clients)]);
    return [make("h3", "", say("outputs")), table(["name", "clients"], rows)];
  }

  private nodeName(name: string): HTMLElement {
    const cell = make("span");
    if (this.renaming !== name) {
      cell.append(name);
      if (this.may.includes("name")) {
        const change = button(say("rename"), "rename", () => {
          this.renaming = name;
          this.render();
        });
        change.dataset["node"] = name;
        cell.append(change);
      }
      return cell;
    }
    const form = make("form");
    const input = make("input");
    input.value = name;
    input.maxLength = 40;
    input.setAttribute("aria-label", say("renameHelp", name));
    const done = (): void => {
      this.renaming = null;
      this.render();
    };
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const wanted = input.value.trim();
      if (wanted && wanted !== name) this.rename(name, wanted);
      if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
      done();
    });
    input.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      input.blur();
      done();
    });
    const cancel = button(say("cancel"), "", () => {
      cancel.blur();
      done();
    });
    form.append(input, make("button", "", say("save")), cancel);
    cell.append(form);
    return cell;
  }
}

function table(heads: readonly Key[], rows: readonly (readonly (string | HTMLElement)[])[]): HTMLElement {
  const made = make("table");
  const head = made.createTHead().insertRow();
  for (const key of heads) head.append(make("th", key === "state" ? "left" : "", say(key)));
  const body = made.createTBody();
  for (const cells of rows) {
    const row = body.insertRow();
    cells.forEach((cell, k) => {
      const place = row.insertCell();
      if (heads[k] === "state") place.className = "left";
      place.append(cell);
    });
  }
  const scroll = make("div", "scroll");
  scroll.append(made);
  return scroll;
}
