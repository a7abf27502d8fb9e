// A surface as an object of three.js: a mesh whose geometry is changed by each step, for scenes of one's own.

import * as THREE from 'three';
import { CuestaSurface, type OpenOptions } from './surface.ts';
import { type Aim, type Change, eachRange, type Source, usualAim, type View, wordsOfVertex } from './types.ts';

/** Positions are relative to the middle of the file's box, which is where the mesh is put: move a parent, not the mesh, to
 *  have it elsewhere. Its groups are the pages. */
export class CuestaMesh extends THREE.Mesh<THREE.BufferGeometry, THREE.Material[]> {
  aim: Aim = { ...usualAim };
  /** Says what cannot be had; what is there stays, coarser. */
  onFailure: (message: string) => void = () => {};
  private readonly middle: [number, number, number];

  static async open(source: Source, material: THREE.Material = plain(), options: OpenOptions = {}) {
    return new CuestaMesh(await CuestaSurface.open(source, options), material);
  }

  constructor(
    readonly surface: CuestaSurface,
    material: THREE.Material = plain(),
  ) {
    super(new THREE.BufferGeometry(), [material]);
    const [lo, hi] = surface.facts.box;
    this.middle = [0, 1, 2].map((i) => (lo[i] + hi[i]) / 2) as [number, number, number];
    this.position.set(...this.middle);
    const radius = Math.hypot(...[0, 1, 2].map((i) => hi[i] - lo[i])) / 2;
    this.geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), radius);
    surface.onChange = (change) => this.apply(change);
    surface.onFailure = (message) => this.onFailure(message);
  }

  /** To be called for each frame: asks for what the camera sees of it, in a picture of that height. */
  look(camera: THREE.PerspectiveCamera, heightPx: number) {
    this.updateWorldMatrix(true, false);
    camera.updateMatrixWorld();
    const toFile = new THREE.Matrix4().makeTranslation(...this.middle).multiply(this.matrixWorld.clone().invert());
    const eye = new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld);
    const ahead = new THREE.Vector3(0, 0, -1).transformDirection(camera.matrixWorld).add(eye);
    const up = new THREE.Vector3(0, 1, 0).transformDirection(camera.matrixWorld);
    const view: View = {
      eye: eye.applyMatrix4(toFile).toArray(),
      target: ahead.applyMatrix4(toFile).toArray(),
      up: up.transformDirection(toFile).toArray(),
      fovY: THREE.MathUtils.degToRad(camera.getEffectiveFOV()),
      width: Math.max(1, Math.round(heightPx * camera.aspect)),
      height: Math.max(1, Math.round(heightPx)),
    };
    this.surface.look(view, this.aim);
  }

  dispose() {
    this.surface.close();
    this.geometry.dispose();
  }

  private apply(change: Change) {
    const { geometry } = this;
    const position = this.attribute('position', change.vertexCount, (n) => new THREE.BufferAttribute(new Float32Array(3 * n), 3));
    const normal = this.attribute('normal', change.vertexCount, (n) => new THREE.BufferAttribute(new Int8Array(4 * n), 4, true));
    const color = this.attribute('color', change.vertexCount, (n) => new THREE.BufferAttribute(new Uint8Array(4 * n), 4, true));
    eachRange(change.vertexRanges, (first, count, at) => {
      for (let i = 0; i < count; ++i) this.put(change.vertices, at + i, first + i, position, normal, color);
      for (const a of [position, normal, color]) touch(a, first, count);
    });
    const index = this.index(change.indexCount);
    eachRange(change.indexRanges, (first, count, at) => {
      index.array.set(change.indices.subarray(at, at + count), first);
      touch(index, first, count);
    });
    geometry.clearGroups();
    for (let i = 0; i < change.draws.length; i += 2) geometry.addGroup(change.draws[i], change.draws[i + 1], 0);
  }

  private put(
    words: Uint32Array,
    from: number,
    to: number,
    position: THREE.BufferAttribute,
    normal: THREE.BufferAttribute,
    color: THREE.BufferAttribute,
  ) {
    const { origin, step } = this.surface.facts.grid;
    const at = from * wordsOfVertex;
    for (let c = 0; c < 3; ++c) position.array[3 * to + c] = origin[c] - this.middle[c] + step * (words[at + c] | 0);
    const n = decodedNormal((words[at + 3] << 16) >> 16, words[at + 3] >> 16);
    for (let c = 0; c < 3; ++c) normal.array[4 * to + c] = Math.round(127 * n[c]);
    // Vertex colours of three.js are linear.
    for (let c = 0; c < 3; ++c) color.array[4 * to + c] = linearByte[(words[at + 4] >>> (8 * c)) & 255];
    color.array[4 * to + 3] = words[at + 4] >>> 24;
  }

  /** Of at least so many elements; a larger one keeps what the smaller one had. */
  private attribute(name: string, count: number, make: (count: number) => THREE.BufferAttribute): THREE.BufferAttribute {
    const old = this.geometry.getAttribute(name) as THREE.BufferAttribute | undefined;
    if (old && old.count >= count) return old;
    const larger = make(Math.max(count, old ? Math.ceil(old.count * 1.5) : 0)).setUsage(THREE.DynamicDrawUsage);
    if (old) larger.array.set(old.array);
    this.geometry.setAttribute(name, larger);
    return larger;
  }

  private index(count: number): THREE.BufferAttribute {
    const old = this.geometry.index;
    if (old && old.count >= count) return old;
    const larger = new THREE.BufferAttribute(new Uint32Array(Math.max(count, old ? Math.ceil(old.count * 1.5) : 0)), 1);
    larger.setUsage(THREE.DynamicDrawUsage);
    if (old) larger.array.set(old.array);
    this.geometry.setIndex(larger);
    return larger;
  }
}

function touch(attribute: THREE.BufferAttribute, first: number, count: number) {
  attribute.addUpdateRange(first * attribute.itemSize, count * attribute.itemSize);
  attribute.needsUpdate = true;
}

function plain() {
  return new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.8 });
}

const linearByte = Uint8Array.from({ length: 256 }, (_, i) => {
  const c = i / 255;
  return Math.round(255 * (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
});

function decodedNormal(u: number, v: number): [number, number, number] {
  if (u === -32768 && v === -32768) return [0, 0, 1];
  let [x, y] = [u / 32767, v / 32767];
  const z = 1 - Math.abs(x) - Math.abs(y);
  const fold = Math.max(-z, 0);
  x += x >= 0 ? -fold : fold;
  y += y >= 0 ? -fold : fold;
  const size = Math.hypot(x, y, z);
  return [x / size, y / size, z / size];
}
