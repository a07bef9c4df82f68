// Notes of the hub, for a while at the foot of the page, errors longest; each can be dismissed.

import type { Note } from "../protocol";
import { lang } from "../text";
import { closeButton, find, icon, make } from "./dom";

const MOST = 4;
const STAY_MS = { info: 5000, warning: 9000, error: 60000 } as const;
const SIGNS = { info: "M10 9v5M10 6v.1", warning: "M10 3 2.500 16.500h15zM10 8v4M10 14v.1", error: "M6 6l8 8M14 6l-8 8" } as const;

export class Toasts {
  private readonly root = find("#toasts");

  show(note: Note): void {
    const text = note[lang()];
    for (const old of this.root.children) {
      if (!(old instanceof HTMLElement) || old.dataset["note"] !== text) continue;
      const times = Number(old.dataset["times"] ?? 1) + 1;
      old.dataset["times"] = String(times);
      find("small", old).textContent = `×${times}`;
      return;
    }
    const toast = make("div", `toast ${note.level}`);
    toast.dataset["note"] = text;
    const close = closeButton(() => toast.remove(), "dismiss");
    toast.append(icon(SIGNS[note.level]), make("p", "", text), make("small"), close);
    this.root.append(toast);
    while (this.root.childElementCount > MOST) this.root.firstElementChild?.remove();
    setTimeout(() => toast.remove(), STAY_MS[note.level]);
  }
}
