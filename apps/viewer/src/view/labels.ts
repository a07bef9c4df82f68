// Names beside bodies: small signs whose picture is painted anew only when name, source or theme change.

import * as THREE from "three";
import { paintSign, type Look } from "../source";
import type { Source } from "../protocol";
import type { Theme } from "../settings";

const HEIGHT = 22;
const FONT = '600 12px system-ui, -apple-system, "Segoe UI", "Hiragino Sans", "Yu Gothic UI", "Noto Sans JP", "Noto Sans CJK JP", sans-serif';
const LONGEST_PX = 220;

export class Label {
  readonly sprite: THREE.Sprite;
  private readonly canvas = document.createElement("canvas");
  private texture: THREE.CanvasTexture | null = null;
  private shown = "";
  private width = 1;
  private unit = 0;

  constructor() {
    const material = new THREE.SpriteMaterial({ sizeAttenuation: false, depthTest: false, transparent: true, toneMapped: false });
    this.sprite = new THREE.Sprite(material);
    this.sprite.center.set(0, 0.5);
    this.sprite.renderOrder = 5;
    this.sprite.visible = false;
  }

  paint(text: string, source: Source, look: Look, theme: Theme, chosen: boolean): void {
    const key = `${text}|${source}|${theme}|${chosen}|${devicePixelRatio}`;
    if (key === this.shown) return;
    this.shown = key;
    const scale = Math.min(3, Math.max(1, devicePixelRatio));
    const pen = this.canvas.getContext("2d");
    if (!pen) return;
    pen.font = FONT;
    const width = Math.ceil(Math.min(LONGEST_PX, pen.measureText(text).width)) + 32;
    this.canvas.width = width * scale;
    this.canvas.height = HEIGHT * scale;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.beginPath();
    pen.roundRect(0.75, 0.75, width - 1.5, HEIGHT - 1.5, HEIGHT / 2);
    pen.fillStyle = theme === "dark" ? "rgba(20, 25, 33, .82)" : "rgba(255, 255, 255, .86)";
    pen.fill();
    pen.lineWidth = chosen ? 1.5 : 1;
    pen.strokeStyle = chosen ? look.css : theme === "dark" ? "rgba(255, 255, 255, .14)" : "rgba(20, 30, 50, .14)";
    pen.stroke();
    pen.fillStyle = look.css;
    pen.strokeStyle = look.css;
    paintSign(pen, source, 12, HEIGHT / 2, 11);
    pen.fillStyle = theme === "dark" ? "#e7ebf2" : "#1b2330";
    pen.font = FONT;
    pen.textBaseline = "middle";
    pen.fillText(text, 22, HEIGHT / 2 + 0.5, LONGEST_PX);
    this.width = width;
    // A texture's size is fixed once it is on the card.
    this.texture?.dispose();
    this.texture = new THREE.CanvasTexture(this.canvas);
    this.texture.colorSpace = THREE.SRGBColorSpace;
    this.texture.generateMipmaps = false;
    this.texture.minFilter = THREE.LinearFilter;
    this.sprite.material.map = this.texture;
    this.sprite.material.needsUpdate = true;
    this.size(this.unit);
  }

  /** `unit`: size of one CSS pixel at a distance of 1. */
  size(unit: number): void {
    this.unit = unit;
    this.sprite.scale.set(this.width * unit, HEIGHT * unit, 1);
    this.sprite.center.set(-12 / this.width, 0.5);
  }

  dispose(): void {
    this.texture?.dispose();
    this.sprite.material.dispose();
  }
}
