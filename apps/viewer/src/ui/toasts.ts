// Notes of the hub, for a while at the foot of the page; errors until they are dismissed.

import type { Note } from "../protocol";
import { lang, say } from "../text";
import { find, make } from "./dom";

const MOST = 4;
const STAY_MS = { info: 5000, warning: 9000, error: 60000 } as const;
const SIGNS = { info: "M10 9v5M10 6v.1", warning: "M10 3 2.500 16.500h15zM10 8v4M10 14v.1", error: "M6 6l8 8M14 6l-8 8" } as const;
const SVG = "http://www.w3.org/2000/svg";

export class Toasts {
  private readonly root = find("#toasts");

  show(note: Note): void {
    const text = note[lang()];
    for (const old of this.root.children) {
      if (!(old instanceof HTMLElement) || old.dataset["text"] !== text) continue;
      const times = Number(old.dataset["times"] ?? 1) + 1;
      old.dataset["times"] = String(times);
      find("small", old).textContent = `×${times}`;
      return;
    }
    const toast = make("div", `toast ${note.level}`);
    toast.dataset["text"] = text;
    const icon = document.createElementNS(SVG, "svg");
    icon.setAttribute("viewBox", "0 0 20 20");
    icon.setAttribute("aria-hidden", "true");
    const path = document.createElementNS(SVG, "path");
    path.setAttribute("d", SIGNS[note.level]);
    icon.append(path);
    const close = make("button", "icon close", "×");
    close.type = "button";
    close.setAttribute("aria-label", say("dismiss"));
    close.addEventListener("click", () => toast.remove());
    toast.append(icon, make("p", "", text), make("small"), close);
    this.root.append(toast);
    while (this.root.childElementCount > MOST) this.root.firstElementChild?.remove();
    setTimeout(() => toast.remove(), STAY_MS[note.level]);
  }
}
