// How fast frames come, and how long we work on one; numbers for the status panel and for tests.

const KEPT = 240;

export class Pace {
  private readonly apart_ms = new Float64Array(KEPT);
  private readonly work_ms = new Float64Array(KEPT);
  private count = 0;
  private last_ms = 0;

  add(now_ms: number, work_ms: number): void {
    const k = this.count % KEPT;
    this.apart_ms[k] = this.last_ms > 0 ? now_ms - this.last_ms : 0;
    this.work_ms[k] = work_ms;
    this.last_ms = now_ms;
    this.count++;
  }

  /** Frames a second and the middle of our own work a frame, over the last ones. */
  read(): { fps: number; work_ms: number } {
    const held = Math.min(this.count, KEPT);
    if (held < 2) return { fps: NaN, work_ms: NaN };
    let sum = 0;
    for (let k = 0; k < held; k++) sum += this.apart_ms[k]!;
    const work = [...this.work_ms.subarray(0, held)].sort((a, b) => a - b);
    return { fps: (1000 * held) / sum, work_ms: work[held >> 1]! };
  }

  /** Frames since the last clearing. */
  frames(): number {
    return this.count;
  }

  clear(): void {
    this.count = 0;
    this.last_ms = 0;
  }
}
