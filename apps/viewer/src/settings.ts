// What the page remembers: language, theme, what is shown.

import type { Lang } from "./text";

export type Theme = "light" | "dark";

export interface Settings {
  lang: Lang;
  /** Nothing: as the system has it. */
  theme: Theme | null;
  trails: boolean;
  labels: boolean;
  /** Panels that are open. */
  bodies: boolean;
  status: boolean;
}

const KEY = "shisei.viewer";

/** The address wins over what is remembered, that over what the browser prefers. */
export function load(search: string, remembered: string | null, languages: readonly string[]): Settings {
  const query = new URLSearchParams(search);
  let kept: Record<string, unknown> = {};
  try {
    const value: unknown = JSON.parse(remembered ?? "{}");
    if (typeof value === "object" && value !== null) kept = value as Record<string, unknown>;
  } catch {
    // written by something else: as if nothing were there
  }
  const lang = (value: unknown): Lang | null => (value === "en" || value === "ja" ? value : null);
  const theme = (value: unknown): Theme | null => (value === "light" || value === "dark" ? value : null);
  const preferred = languages.find((name) => /^(en|ja)\b/.test(name))?.slice(0, 2);
  return {
    lang: lang(query.get("lang")) ?? lang(kept["lang"]) ?? lang(preferred) ?? "en",
    theme: theme(query.get("theme")) ?? theme(kept["theme"]),
    trails: kept["trails"] !== false,
    labels: kept["labels"] !== false,
    bodies: kept["bodies"] !== false,
    status: kept["status"] === true,
  };
}

export function remembered(): string | null {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}

export function remember(settings: Settings): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(settings));
  } catch {
    // a browser that keeps nothing still shows everything
  }
}
