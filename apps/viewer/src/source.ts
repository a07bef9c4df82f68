// How the four sources look: a colour for each theme and, for who cannot tell colours apart, a line pattern and a
// sign. The same signs stand in the legend, the list, the labels and the graphs.

import { Source } from "./protocol";
import type { Theme } from "./settings";

/** Lines drawn through, dashed or dotted; see view/links.ts. */
export const enum Pattern {
  Solid = 0,
  Dashed = 1,
  Dotted = 2,
}

export interface Look {
  /** Key of its name in text.ts. */
  name: "vanished" | "optical" | "bridged" | "inertial";
  pattern: Pattern;
  /** Red, green, blue from 0 to 1 (sRGB), and how solid. */
  rgba: Float32Array;
  css: string;
}

const COLOURS: Record<Theme, readonly string[]> = {
  // in the order of Source
  light: ["#7b8494", "#1a73c7", "#c76a00", "#8546c9"],
  dark: ["#8f9aab", "#5fb0f5", "#ffae42", "#bd93f9"],
};

const NAMES = ["vanished", "optical", "bridged", "inertial"] as const;
const PATTERNS = [Pattern.Dotted, Pattern.Solid, Pattern.Dashed, Pattern.Dotted] as const;
const SOLIDITY = [0.45, 1, 1, 1] as const;

const look = (theme: Theme, source: number): Look => {
  const css = COLOURS[theme][source] ?? "#888888";
  const channel = (at: number): number => parseInt(css.slice(at, at + 2), 16) / 255;
  return {
    name: NAMES[source] ?? "vanished",
    pattern: PATTERNS[source] ?? Pattern.Solid,
    rgba: new Float32Array([channel(1), channel(3), channel(5), SOLIDITY[source] ?? 1]),
    css,
  };
};

const ALL = [Source.None, Source.Optical, Source.Bridged, Source.Inertial];
const LOOKS: Record<Theme, readonly Look[]> = {
  light: ALL.map((source) => look("light", source)),
  dark: ALL.map((source) => look("dark", source)),
};

export function lookOf(theme: Theme, source: Source): Look {
  return LOOKS[theme][source] ?? LOOKS[theme][0]!;
}

const SVG = "http://www.w3.org/2000/svg";

/** The sign of a source: a disc, a dashed ring, a dotted ring with a point, a cross. Coloured by CSS. */
export function sign(source: Source): SVGSVGElement {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  svg.setAttribute("class", `sign source-${source}`);
  const add = (name: string, attributes: Record<string, string>): void => {
    const part = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) part.setAttribute(key, value);
    svg.append(part);
  };
  const ring = { cx: "8", cy: "8", r: "5.5", fill: "none", stroke: "currentColor", "stroke-width": "2.4" };
  switch (source) {
    case Source.Optical:
      add("circle", { cx: "8", cy: "8", r: "6", fill: "currentColor" });
      break;
    case Source.Bridged:
      add("circle", { ...ring, "stroke-dasharray": "5.2 3.44" });
      break;
    case Source.Inertial:
      add("circle", { ...ring, "stroke-width": "2", "stroke-dasharray": "0.1 4.22", "stroke-linecap": "round" });
      add("circle", { cx: "8", cy: "8", r: "2.4", fill: "currentColor" });
      break;
    default:
      add("path", { d: "M3.5 3.5 12.5 12.5M12.5 3.5 3.5 12.5", stroke: "currentColor", "stroke-width": "2.4", "stroke-linecap": "round" });
  }
  return svg;
}

/** The same sign on a canvas, `size` pixels wide, its middle at (x, y). */
export function paintSign(pen: CanvasRenderingContext2D, source: Source, x: number, y: number, size: number): void {
  const unit = size / 16;
  pen.beginPath();
  pen.lineWidth = 2.4 * unit;
  pen.lineCap = "butt";
  if (source === Source.Optical) {
    pen.arc(x, y, 6 * unit, 0, 2 * Math.PI);
    pen.fill();
  } else if (source === Source.None) {
    pen.lineCap = "round";
    const reach = 4.5 * unit;
    pen.moveTo(x - reach, y - reach);
    pen.lineTo(x + reach, y + reach);
    pen.moveTo(x + reach, y - reach);
    pen.lineTo(x - reach, y + reach);
    pen.stroke();
  } else {
    pen.setLineDash(source === Source.Bridged ? [5.2 * unit, 3.44 * unit] : [2 * unit, 2.32 * unit]);
    pen.arc(x, y, 5.5 * unit, 0, 2 * Math.PI);
    pen.stroke();
    pen.setLineDash([]);
    if (source === Source.Inertial) {
      pen.beginPath();
      pen.arc(x, y, 2.4 * unit, 0, 2 * Math.PI);
      pen.fill();
    }
  }
}
