// One attribute of a mesh that is written anew every frame; only the part in use goes to the graphics card.

import * as THREE from "three";

export class Column {
  readonly array: Float32Array;
  private readonly attribute: THREE.BufferAttribute;
  private readonly range = { start: 0, count: 0 };

  /** `size` numbers for each of `most` vertices, or instances. */
  constructor(geometry: THREE.BufferGeometry, name: string, private readonly size: number, most: number, instanced: boolean) {
    this.array = new Float32Array(size * most);
    this.attribute = instanced ? new THREE.InstancedBufferAttribute(this.array, size) : new THREE.BufferAttribute(this.array, size);
    this.attribute.setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute(name, this.attribute);
  }

  upload(count: number): void {
    this.range.start = 0;
    this.range.count = Math.max(1, count * this.size);
    this.attribute.updateRanges.length = 0;
    this.attribute.updateRanges.push(this.range);
    this.attribute.needsUpdate = true;
  }
}
