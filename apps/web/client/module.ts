// The module's functions (exports.cpp) with the types that JavaScript has.

import type { AskedPage } from './page_fetcher.ts';
import type { Binding, Report, Shaders, SurfaceFacts } from './types.ts';

interface Exports {
  HEAPU8: Uint8Array;
  _malloc(bytes: number): number;
  _free(at: number): void;
  _text_at(): number;
  _create(name: number, bytes: number, isScene: number): void;
  _deliver(offset: number, at: number, bytes: number): void;
  _open_surface(cacheBytes: number, out: number): number;
  _first_view(numbers: number, out: number): void;
  _step(numbers: number, out: number): number;
  _take_asked(out: number): number;
  _bring(page: number, at: number, bytes: number): void;
  _give_up(page: number, why: number): void;
  _first_error(): void;
  _distance_along(numbers: number): number;
  _place(numbers: number): void;
  _shaders(fragmentDepth: number): void;
}

export type Factory = (options: { locateFile(): string }) => Promise<Exports>;

const bindings: Binding[] = ['nothing', 'adapt time', 'triangles', 'page loads', 'resident bytes', 'upload bytes'];
const scratchNumbers = 1024; // each way: more than any function takes or gives

export class Module {
  private readonly scratch: number;

  private constructor(private readonly m: Exports) {
    this.scratch = m._malloc(2 * scratchNumbers * 8);
  }

  static async load(factory: Factory, wasm: string) {
    return new Module(await factory({ locateFile: () => wasm }));
  }

  memoryBytes() {
    return this.m.HEAPU8.byteLength;
  }

  create(name: string, fileBytes: number, isScene: boolean) {
    this.withBytes(new TextEncoder().encode(name + '\0'), (at) => this.m._create(at, fileBytes, isScene ? 1 : 0));
  }

  deliver(offset: number, bytes: Uint8Array) {
    this.withBytes(bytes, (at) => this.m._deliver(offset, at, bytes.length));
  }

  /** The facts of an open surface, or the range that it lacks. Throws what is wrong with the file. */
  open(cacheBytes: number): SurfaceFacts | [offset: number, bytes: number] {
    const state = this.m._open_surface(cacheBytes, this.out);
    if (state === 2) throw new Error(this.text());
    if (state === 0) return JSON.parse(this.text()) as SurfaceFacts;
    const [offset, bytes] = this.numbers(2);
    return [offset, bytes];
  }

  firstView(numbers: number[]): number[] {
    this.m._first_view(this.put(numbers), this.out);
    return this.numbers(9);
  }

  step(numbers: number[]): { report: Report; words: Uint32Array } {
    const at = this.m._step(this.put(numbers), this.out);
    const [words, ...r] = this.numbers(17);
    const report: Report = {
      triangles: r[0],
      coarseOperations: r[1],
      fineOperations: r[2],
      pagesLoaded: r[3],
      pagesMissing: r[4],
      morphing: r[5],
      tau: r[6],
      achieved: r[7],
      adaptMs: r[8],
      residentBytes: r[9],
      uploadBytes: r[10],
      boundBy: bindings[r[11]],
      settled: r[12] !== 0,
      residentPages: r[13],
      evictions: r[14],
      failedPages: r[15],
    };
    return { report, words: new Uint32Array(this.m.HEAPU8.buffer, at, words).slice() };
  }

  takeAsked(): AskedPage[] {
    const count = this.m._take_asked(this.out);
    const n = this.numbers(3 * count);
    return Array.from({ length: count }, (_, i) => ({ page: n[3 * i], offset: n[3 * i + 1], bytes: n[3 * i + 2] }));
  }

  bring(page: number, stored: Uint8Array) {
    this.withBytes(stored, (at) => this.m._bring(page, at, stored.length));
  }

  giveUp(page: number, why: string) {
    this.withBytes(new TextEncoder().encode(why + '\0'), (at) => this.m._give_up(page, at));
  }

  firstError(): string {
    this.m._first_error();
    return this.text();
  }

  distanceAlong(numbers: number[]): number {
    return this.m._distance_along(this.put(numbers));
  }

  place(numbers: number[]): string {
    this.m._place(this.put(numbers));
    return this.text();
  }

  shaders(fragmentDepth: boolean): Shaders {
    this.m._shaders(fragmentDepth ? 1 : 0);
    return JSON.parse(this.text()) as Shaders;
  }

  private get out() {
    return this.scratch + scratchNumbers * 8;
  }

  private put(numbers: number[]): number {
    new Float64Array(this.m.HEAPU8.buffer, this.scratch, numbers.length).set(numbers);
    return this.scratch;
  }

  private numbers(count: number): number[] {
    return Array.from(new Float64Array(this.m.HEAPU8.buffer, this.out, count));
  }

  private text(): string {
    const heap = this.m.HEAPU8;
    const at = this.m._text_at();
    return new TextDecoder().decode(heap.slice(at, heap.indexOf(0, at)));
  }

  private withBytes(bytes: Uint8Array, use: (at: number) => void) {
    const at = this.m._malloc(bytes.length);
    if (at === 0) throw new Error('The browser gives no more memory.');
    this.m.HEAPU8.set(bytes, at);
    try {
      use(at);
    } finally {
      this.m._free(at);
    }
  }
}
