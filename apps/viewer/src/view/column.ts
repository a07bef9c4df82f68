// Meshes of many equal parts whose numbers are written anew every frame; only what is in use goes to the graphics card.
//
// With a graphics card a part is an instance. Renderers in software take every instance for a draw call of its own:
// for them the shape is there many times over, and each of its corners has the part's numbers.

import * as THREE from "three";

/** One attribute. */
export class Column {
  /** `size` numbers for each part. */
  readonly array: Float32Array;
  private readonly sent: Float32Array;
  private readonly attribute: THREE.BufferAttribute;
  private readonly range = { start: 0, count: 0 };

  /** `size` numbers for each of `most` parts, of `corners` vertices each; `corners` 0: a part is an instance. */
  constructor(geometry: THREE.BufferGeometry, name: string, private readonly size: number, most: number, private readonly corners: number) {
    this.array = new Float32Array(size * most);
    this.sent = corners > 1 ? new Float32Array(size * most * corners) : this.array;
    this.attribute = corners === 0 ? new THREE.InstancedBufferAttribute(this.sent, size) : new THREE.BufferAttribute(this.sent, size);
    this.attribute.setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute(name, this.attribute);
  }

  upload(count: number): void {
    const { array, sent, size, corners } = this;
    if (corners > 1) {
      let at = 0;
      for (let k = 0; k < count * size; k += size) {
        for (let corner = 0; corner < corners; corner++) for (let j = 0; j < size; j++) sent[at++] = array[k + j]!;
      }
    }
    this.range.start = 0;
    this.range.count = Math.max(1, count * size * Math.max(1, corners));
    this.attribute.updateRanges.length = 0;
    this.attribute.updateRanges.push(this.range);
    this.attribute.needsUpdate = true;
  }
}

/** The shape of all parts of a mesh. */
export class Parts {
  readonly geometry: THREE.BufferGeometry;
  /** What its columns need to know. */
  readonly corners: number;
  private readonly indices: number;

  constructor(shape: THREE.BufferGeometry, most: number, instanced: boolean) {
    const index = shape.index!;
    const position = shape.getAttribute("position");
    this.indices = index.count;
    if (instanced) {
      this.corners = 0;
      this.geometry = new THREE.InstancedBufferGeometry();
      this.geometry.index = index;
      this.geometry.setAttribute("position", position);
      return;
    }
    this.corners = position.count;
    const places = new Float32Array(3 * position.count * most);
    const corners = new Uint32Array(index.count * most);
    for (let part = 0; part < most; part++) {
      places.set(position.array, 3 * position.count * part);
      for (let k = 0; k < index.count; k++) corners[index.count * part + k] = index.getX(k) + position.count * part;
    }
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setIndex(new THREE.BufferAttribute(corners, 1));
    this.geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
  }

  /** So many parts are drawn. */
  show(count: number): void {
    if (this.geometry instanceof THREE.InstancedBufferGeometry) this.geometry.instanceCount = count;
    else this.geometry.setDrawRange(0, this.indices * count);
  }
}
