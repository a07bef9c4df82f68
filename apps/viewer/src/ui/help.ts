// The keys and gestures, shown by `?`.

import { type Key, say } from "../text";
import { closeButton, find, make } from "./dom";

const KEYS: readonly (readonly [string[], Key])[] = [
  [["R"], "keyRecord"],
  [["N", "P"], "keyNext"],
  [["A"], "keyAlign"],
  [["H"], "keyHeading"],
  [["F"], "keyFollow"],
  [["0"], "keyFrame"],
  [["1", "2", "3"], "keyViews"],
  [["←", "→", "↑", "↓"], "keyTurn"],
  [["+", "−"], "keyZoom"],
  [["T"], "keyTrails"],
  [["L"], "keyLabels"],
  [["B"], "keyBodies"],
  [["S"], "keyStatus"],
  [["G"], "keyLang"],
  [["D"], "keyTheme"],
  [["?"], "keyHelp"],
  [["Esc"], "keyEscape"],
];

export class Help {
  private readonly dialog = find<HTMLDialogElement>("#help");

  constructor() {
    // A click beside it closes it.
    this.dialog.addEventListener("click", (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
  }

  get open(): boolean {
    return this.dialog.open;
  }

  toggle(): void {
    if (this.dialog.open) this.dialog.close();
    else {
      this.render();
      this.dialog.showModal();
    }
  }

  private render(): void {
    const head = make("header");
    const close = closeButton(() => this.dialog.close());
    head.append(make("h2", "", say("help")), close);
    const table = make("table");
    for (const [keys, what] of KEYS) {
      const row = table.insertRow();
      row.insertCell().append(...keys.map((key) => make("kbd", "", key)));
      row.insertCell().append(say(what));
    }
    for (const [name, what] of [["mouse", "mouseHelp"], ["touch", "touchHelp"]] as const) {
      const row = table.insertRow();
      row.insertCell().append(say(name));
      row.insertCell().append(say(what));
    }
    this.dialog.setAttribute("aria-label", say("help"));
    this.dialog.replaceChildren(head, table);
  }
}
