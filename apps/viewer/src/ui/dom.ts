// Small helpers for the page. Text from the hub only ever becomes text.

import { type Key, say } from "../text";

const SVG = "http://www.w3.org/2000/svg";

export function find<T extends Element = HTMLElement>(selector: string, within: ParentNode = document): T {
  const found = within.querySelector<T>(selector);
  if (!found) throw new Error(`the page has no ${selector}`);
  return found;
}

export function make<K extends keyof HTMLElementTagNameMap>(name: K, className = "", text = ""): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  if (className) element.className = className;
  if (text) element.textContent = text;
  return element;
}

export function button(text: string, className: string, pressed: () => void): HTMLButtonElement {
  const made = make("button", className, text);
  made.type = "button";
  made.addEventListener("click", pressed);
  return made;
}

/** A small cross that closes something. */
export function closeButton(pressed: () => void, key: Key = "close"): HTMLButtonElement {
  const made = button("", "icon close", pressed);
  made.append(icon("m5 5 10 10M15 5 5 15"));
  made.setAttribute("aria-label", say(key));
  return made;
}

/** Strokes on a square of 20. */
export function icon(strokes: string): SVGSVGElement {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 20 20");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", strokes);
  svg.append(path);
  return svg;
}

/** Writes only what differs, so that nothing is laid out again in vain. */
export function put(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function mark(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

/** Fills every `data-text` and `data-label` in the page's language. */
export function translate(within: ParentNode = document): void {
  for (const element of within.querySelectorAll<HTMLElement>("[data-text]")) put(element, say(element.dataset["text"] as Key));
  for (const element of within.querySelectorAll<HTMLElement>("[data-label]")) {
    const text = say(element.dataset["label"] as Key);
    mark(element, "aria-label", text);
    if (element.matches("button, input")) element.title = text;
  }
}
