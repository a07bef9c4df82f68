// The bar at the top and the sign below it: connection, rates, recording.

import { PROTOCOL, type Ability, type Hello, type Status } from "../protocol";
import type { Connection, Link } from "../connection";
import { say } from "../text";
import { find, mark, put } from "./dom";
import { bytes, clock, DASH, fixed } from "./numbers";

/** A press is taken back when the hub says nothing for so long. */
const PATIENCE_MS = 4000;

export class Bar {
  private readonly link = find("#link");
  private readonly record = find<HTMLButtonElement>("#record");
  private readonly recordText = find("b", this.record);
  private readonly recordTime = find("#record-time");
  private readonly sign = find("#sign");
  private status: Status | null = null;
  private hello: Hello | null = null;
  private state: Link = "connecting";
  /** What was asked for and not yet confirmed. */
  private wanted: boolean | null = null;
  private wanted_ms = 0;

  constructor(private readonly connection: Connection, notSent: () => void) {
    this.record.addEventListener("click", () => {
      if (!this.press()) notSent();
    });
    find("button", this.sign).addEventListener("click", () => {
      if (this.wrongProtocol) location.reload();
      else connection.open();
    });
  }

  private get wrongProtocol(): boolean {
    return this.hello !== null && this.hello.protocol !== PROTOCOL;
  }

  /** Starts or stops the recording; false when it could not be asked for. */
  press(): boolean {
    if (this.record.disabled || this.wanted !== null) return true;
    const on = !this.status?.recording;
    if (!this.connection.send({ type: "record", on })) return false;
    this.wanted = on;
    this.wanted_ms = performance.now();
    this.update(this.wanted_ms);
    return true;
  }

  setHello(hello: Hello): void {
    this.hello = hello;
    find("#demo").hidden = !hello.demo;
  }

  setLink(state: Link): void {
    this.state = state;
    if (state === "lost") {
      this.wanted = null;
      this.status = null;
    }
    document.body.classList.toggle("stale", state === "lost" || state === "silent");
    this.update(performance.now());
  }

  take(status: Status): void {
    this.status = status;
    if (this.wanted !== null && (status.recording !== null) === this.wanted) this.wanted = null;
    this.update(performance.now());
  }

  /** A few times a second. */
  update(now_ms: number): void {
    const { state, status } = this;
    mark(this.link, "data-link", state);
    put(find("b", this.link), say(state));
    this.sign.hidden = state !== "lost" && state !== "silent" && !this.wrongProtocol;
    document.body.classList.toggle("signed", !this.sign.hidden);
    if (!this.sign.hidden) {
      const lost = state === "lost";
      const wait = Math.max(0, Math.ceil((this.connection.next_ms - now_ms) / 1000));
      put(find("b", this.sign), lost ? say("lostSign") : state === "silent" ? say("silentSign") : say("wrongProtocol", this.hello?.protocol ?? DASH, PROTOCOL));
      put(find("span", this.sign), lost ? say("nextTry", wait) : "");
      find("button", this.sign).hidden = !lost && !this.wrongProtocol;
    }
    this.vitals(status);
    this.recording(now_ms);
  }

  private vitals(status: Status | null): void {
    const inputs = status?.inputs ?? [];
    const rate = inputs.reduce((sum, input) => sum + (input.rate_hz ?? 0), 0);
    // an input's are those of its nodes, or frames of the cameras
    const lost = inputs.reduce((sum, input) => sum + (input.lost ?? 0), 0);
    put(find("#v-rate"), status ? `${fixed(rate, 0)} Hz` : "");
    put(find("#v-latency"), status && status.latency_ms.median !== null ? `${say("latency")} ${fixed(status.latency_ms.median, 1)} ms` : "");
    put(find("#v-loss"), status ? `${say("lostCount")} ${lost}` : "");
  }

  private recording(now_ms: number): void {
    if (this.wanted !== null && now_ms - this.wanted_ms > PATIENCE_MS) this.wanted = null;
    const recording = this.status?.recording ?? null;
    const ability: Ability = "record";
    const may = this.hello?.may.includes(ability) ?? false;
    this.record.disabled = !may || this.state === "lost" || this.state === "connecting" || this.wanted !== null;
    this.record.title = recording ? recording.file : !may && this.hello ? say("cannotRecord") : "";
    mark(this.record, "data-state", recording ? "on" : "off");
    const text = this.wanted === true ? say("starting") : this.wanted === false ? say("stopping") : say(recording ? "stop" : "record");
    put(this.recordText, text);
    put(this.recordTime, recording ? `${clock(recording.seconds)} · ${bytes(recording.bytes)}` : "");
    const title = `${recording ? "● " : ""}${this.state === "lost" ? "! " : ""}${say("title")}`;
    if (document.title !== title) document.title = title;
  }
}
