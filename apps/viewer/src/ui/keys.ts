// The keyboard. Nothing here is lost to text fields, and keys with Ctrl, Alt or ⌘ stay the browser's.

export type Deed =
  | "record" | "next" | "previous" | "align" | "heading" | "follow" | "everything" | "top" | "front" | "side"
  | "left" | "right" | "up" | "down" | "moveLeft" | "moveRight" | "moveUp" | "moveDown" | "nearer" | "farther"
  | "trails" | "labels" | "bodies" | "status" | "lang" | "theme" | "help" | "escape";

const PLAIN: Readonly<Record<string, Deed>> = {
  r: "record", n: "next", p: "previous", a: "align", h: "heading", f: "follow", "0": "everything", "1": "top", "2": "front", "3": "side",
  arrowleft: "left", arrowright: "right", arrowup: "up", arrowdown: "down", "+": "nearer", "=": "nearer", "-": "farther",
  t: "trails", l: "labels", b: "bodies", s: "status", g: "lang", d: "theme", "?": "help", escape: "escape",
};

const SHIFTED: Readonly<Record<string, Deed>> = { arrowleft: "moveLeft", arrowright: "moveRight", arrowup: "moveUp", arrowdown: "moveDown" };

export interface KeyPress {
  key: string;
  shiftKey: boolean;
  ctrlKey: boolean;
  altKey: boolean;
  metaKey: boolean;
  repeat: boolean;
}

/** What a key asks for; of the keys that act on the hub only the first of a held one. */
export function deedOf(press: KeyPress): Deed | null {
  if (press.ctrlKey || press.altKey || press.metaKey) return null;
  const key = press.key.toLowerCase();
  const deed = (press.shiftKey ? SHIFTED[key] : undefined) ?? PLAIN[key] ?? null;
  const held = deed !== null && /^(left|right|up|down|move|nearer|farther)/.test(deed);
  return press.repeat && !held ? null : deed;
}

export function listen(act: (deed: Deed) => void, modal: () => boolean): void {
  addEventListener("keydown", (event) => {
    const target = event.target;
    const typing = target instanceof HTMLElement && target.closest("input, textarea, select, [contenteditable]") !== null;
    if (typing) {
      if (event.key === "Escape") (target as HTMLElement).blur();
      return;
    }
    const deed = deedOf(event);
    // Escape closes a dialog by itself.
    if (!deed || (modal() && deed !== "help")) return;
    event.preventDefault();
    act(deed);
  });
}
