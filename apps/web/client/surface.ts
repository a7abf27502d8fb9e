// A surface that is open: the worker's other end. Steps go one at a time; what each changes goes to `onChange`.

import {
  type Aim,
  type Change,
  changeOf,
  type FromWorker,
  type Report,
  type SceneChange,
  sceneChangeOf,
  type Shaders,
  type Source,
  type SurfaceFacts,
  type ToWorker,
  type Traffic,
  type Vec3,
  type View,
} from './types.ts';

export interface OpenOptions {
  /** Bytes of pages that are kept; a hard limit. Default: 256 MiB. */
  cacheBytes?: number;
  /** Where worker.js and cuesta.wasm lie. Default: beside this file. */
  assets?: string | URL;
}

type Question = Extract<ToWorker, { kind: 'ask' }>['question'];
type Answer = Extract<FromWorker, { kind: 'answer' }>['value'];

export class CuestaSurface {
  /** Called with each step that changed something, or that changes what is to be drawn. */
  onChange: (change: Change, report: Report, traffic: Traffic) => void = () => {};
  /** Of a scene (`facts.scene`), in place of onChange. */
  onSceneChange: (change: SceneChange, report: Report, traffic: Traffic) => void = () => {};
  /** It is tried again; empty: it is over. */
  onTrouble: (message: string) => void = () => {};
  /** Something cannot be had any more; what is there stays, coarser. */
  onFailure: (message: string) => void = () => {};

  readonly facts: SurfaceFacts;
  readonly shaders: { clipControl: Shaders; fragmentDepth: Shaders };
  private busy = false;
  private wanted: number[] | null = null; // newest, while a step is under way
  private settledAt: string | null = null;
  private lastSent = '';
  private nextId = 0;
  private readonly waiting = new Map<number, (value: Answer) => void>();

  private constructor(
    private readonly worker: Worker,
    opened: Extract<FromWorker, { kind: 'opened' }>,
  ) {
    this.facts = opened.facts;
    this.shaders = opened.shaders;
    worker.onmessage = (event: MessageEvent<FromWorker>) => this.take(event.data);
  }

  /** Header, directory and coarsest page are fetched. Rejects with a message for people. */
  static open(source: Source, options: OpenOptions = {}): Promise<CuestaSurface> {
    const assets = new URL(options.assets ?? '.', import.meta.url);
    const worker = new Worker(new URL('worker.js', assets), { type: 'module' });
    const address = typeof source === 'string' ? new URL(source, document.baseURI).href : source;
    return new Promise((resolve, reject) => {
      const refuse = (message: string) => (worker.terminate(), reject(new Error(message)));
      worker.onerror = () => refuse(`The worker cannot be started: is worker.js at ${assets.href}?`);
      worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
        if (data.kind === 'opened') resolve(new CuestaSurface(worker, data));
        if (data.kind === 'failed') refuse(data.message);
      };
      worker.postMessage({
        kind: 'open',
        source: address,
        name: nameOf(source),
        wasm: new URL('cuesta.wasm', assets).href,
        cacheBytes: options.cacheBytes ?? 256 << 20,
      } satisfies ToWorker);
    });
  }

  /** A step towards this view, unless it is settled there. While one is under way, the newest view waits for its turn. */
  look(view: View, aim: Aim) {
    const numbers = [
      ...numbersOf(view),
      aim.tau,
      aim.exaggeration,
      aim.geomorphMs,
      aim.triangles,
      aim.uploadBytes,
      aim.adaptMs,
    ];
    if (this.settledAt === numbers.join()) return;
    if (this.busy) this.wanted = numbers;
    else this.send(numbers);
  }

  /** True if another step with the last view and aim would change nothing. */
  get settled() {
    return this.settledAt !== null && !this.busy;
  }

  /** Eye, target and up that show all of it, with the angle and the size of `view`; its up where the file tells none. */
  async firstView(view: View, exaggeration = 1): Promise<View> {
    const n = (await this.ask('firstView', [...numbersOf(view), exaggeration])) as number[];
    const vector = (at: number): Vec3 => [n[at], n[at + 1], n[at + 2]];
    return { ...view, eye: vector(0), target: vector(3), up: vector(6) };
  }

  /** To the nearest drawn triangle along a unit direction; Infinity without. */
  async distanceAlong(origin: Vec3, direction: Vec3, exaggeration = 1): Promise<number> {
    return (await this.ask('distance', [...origin, ...direction, exaggeration])) as number;
  }

  /** Where a drawn point is, in words; empty for what is no terrain. */
  async place(point: Vec3, exaggeration = 1): Promise<string> {
    return (await this.ask('place', [...point, exaggeration])) as string;
  }

  close() {
    this.worker.terminate();
  }

  private ask(question: Question, numbers: number[]): Promise<Answer> {
    const id = this.nextId++;
    this.post({ kind: 'ask', id, question, numbers });
    return new Promise((resolve) => this.waiting.set(id, resolve));
  }

  private post(message: ToWorker) {
    this.worker.postMessage(message);
  }

  private send(numbers: number[]) {
    this.busy = true;
    this.wanted = null;
    this.settledAt = null;
    this.lastSent = numbers.join();
    this.post({ kind: 'step', numbers });
  }

  private take(message: FromWorker) {
    if (message.kind === 'stepped') {
      this.busy = false;
      if (message.report.settled) this.settledAt = this.lastSent;
      const { words, report, traffic } = message;
      if (this.facts.scene) this.onSceneChange(sceneChangeOf(words), report, traffic);
      else this.onChange(changeOf(words), report, traffic);
      if (this.wanted) this.send(this.wanted);
    }
    if (message.kind === 'arrived') this.settledAt = null;
    if (message.kind === 'answer') {
      this.waiting.get(message.id)?.(message.value);
      this.waiting.delete(message.id);
    }
    if (message.kind === 'trouble') this.onTrouble(message.message);
    if (message.kind === 'failed') this.onFailure(message.message);
  }
}

function numbersOf(v: View): number[] {
  return [...v.eye, ...v.target, ...v.up, v.fovY, v.width, v.height];
}

function nameOf(source: Source): string {
  if (typeof source === 'string') return source;
  return source instanceof File ? source.name : 'file';
}
