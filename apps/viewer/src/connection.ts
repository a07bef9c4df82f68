// The stream's WebSocket: comes back by itself, and says so while it is away.

import { type Message, parse, type Request } from "./protocol";

export type Link = "connecting" | "live" | "silent" | "lost";

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;
/** A hub says something at least once a second. */
const SILENT_MS = 3000;
/** After so much silence the connection is given up and made anew. */
const DEAD_MS = 10000;

/** The stream beside a page, with the page's token. */
export function streamAddress(page: { protocol: string; host: string; search: string }): string {
  const token = new URLSearchParams(page.search).get("token");
  const query = token ? `?token=${encodeURIComponent(token)}` : "";
  return `${page.protocol === "https:" ? "wss:" : "ws:"}//${page.host}/stream${query}`;
}

/** How long to wait before the `attempt`th try; grows, with a little chance so that pages do not come all at once. */
export function wait_ms(attempt: number, chance: number): number {
  return Math.min(LONGEST_WAIT_MS, FIRST_WAIT_MS * 2 ** Math.min(attempt, 8)) * (0.8 + 0.4 * chance);
}

export class Connection {
  link: Link = "connecting";
  /** When the next try is, on the page's clock; for the sign. */
  next_ms = 0;
  private socket: WebSocket | null = null;
  private attempt = 0;
  private heard_ms = 0;
  private timer = 0;

  constructor(
    private readonly address: string,
    private readonly heard: (message: Message, now_ms: number) => void,
    private readonly changed: (link: Link) => void,
  ) {}

  open(): void {
    clearTimeout(this.timer);
    this.close();
    const socket = new WebSocket(this.address);
    this.socket = socket;
    this.heard_ms = performance.now();
    socket.onmessage = (event: MessageEvent) => {
      if (socket !== this.socket) return;
      const message = typeof event.data === "string" ? parse(event.data) : null;
      if (!message) return;
      this.heard_ms = performance.now();
      this.attempt = 0;
      this.become("live");
      this.heard(message, this.heard_ms);
    };
    socket.onclose = () => {
      if (socket !== this.socket) return;
      this.socket = null;
      this.again();
    };
  }

  /** To be called a few times a second. */
  watch(now_ms: number): void {
    if (!this.socket) return;
    const silence = now_ms - this.heard_ms;
    if (silence > DEAD_MS) {
      this.close();
      this.again();
    } else if (silence > SILENT_MS && this.link === "live") {
      this.become("silent");
    }
  }

  /** True when it went out. */
  send(request: Request): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(request));
    return true;
  }

  private again(): void {
    const wait = wait_ms(this.attempt++, Math.random());
    this.next_ms = performance.now() + wait;
    this.become("lost");
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.open(), wait);
  }

  private become(link: Link): void {
    if (this.link === link) return;
    this.link = link;
    this.changed(link);
  }

  private close(): void {
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }
}
