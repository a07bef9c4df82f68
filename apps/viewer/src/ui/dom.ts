// Small helpers for the page. Text from the hub only ever becomes text.

import { type Key, say } from "../text";

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
