// What colours, lines and signs mean.

import { lookOf, Pattern, sign } from "../source";
import { Source } from "../protocol";
import { say } from "../text";
import { find, make } from "./dom";

const DASHES = { [Pattern.Solid]: "", [Pattern.Dashed]: "6 3.500", [Pattern.Dotted]: "2.500 3.400" };

export function legend(): void {
  const root = find("#legend");
  root.replaceChildren();
  for (const source of [Source.Optical, Source.Bridged, Source.Inertial, Source.None]) {
    const look = lookOf("light", source);
    const line = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    line.setAttribute("viewBox", "0 0 26 12");
    line.setAttribute("class", `line source-${source}`);
    line.setAttribute("aria-hidden", "true");
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    path.setAttribute("d", "M0 6H26");
    if (DASHES[look.pattern]) path.setAttribute("stroke-dasharray", DASHES[look.pattern]);
    line.append(path);
    const item = make("li");
    item.title = say(`${look.name}Help`);
    item.append(sign(source), line, make("span", "", say(look.name)));
    root.append(item);
  }
  const marker = make("li");
  marker.title = say("markerHelp");
  marker.append(make("i"), make("span", "", say("marker")));
  root.append(marker);
}
