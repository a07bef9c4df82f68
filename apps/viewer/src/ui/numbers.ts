// Numbers as people read them. A dash stands for what is not known.

export const DASH = "–";
const MINUS = "−";

/** A proper minus; no "−0.0". */
export function fixed(value: number | null | undefined, digits: number, unit = ""): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  const text = Math.abs(value).toFixed(digits);
  const negative = value < 0 && Number(text) !== 0;
  return `${negative ? MINUS : ""}${text}${unit}`;
}

export function degrees(value: number, digits = 1): string {
  return fixed(value, digits, "°");
}

/** 0:07, 12:34, 1:02:03. */
export function clock(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const two = (value: number): string => String(value).padStart(2, "0");
  const minutes = Math.floor(whole / 60);
  return minutes < 60 ? `${minutes}:${two(whole % 60)}` : `${Math.floor(minutes / 60)}:${two(minutes % 60)}:${two(whole % 60)}`;
}

export function bytes(count: number): string {
  if (count < 1e3) return `${count} B`;
  if (count < 1e6) return `${(count / 1e3).toFixed(0)} kB`;
  if (count < 1e9) return `${(count / 1e6).toFixed(1)} MB`;
  return `${(count / 1e9).toFixed(2)} GB`;
}

export function count(value: number | null): string {
  return value === null ? DASH : String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, "\u2009");
}

/** Brings an angle to −180 … 180°. */
export function wrapped(angle_deg: number): number {
  return angle_deg - 360 * Math.round(angle_deg / 360);
}
