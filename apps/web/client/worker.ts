// The worker: module, fetches and steps. It never waits: a page that is missing is drawn coarser until it comes.

import { BlobSource, HttpSource } from './byte_source.ts';
import { type Factory, Module } from './module.ts';
import { PageFetcher } from './page_fetcher.ts';
import type { FromWorker, ToWorker } from './types.ts';
// @ts-expect-error Emscripten's output has no types
import factory from 'cuesta-module';

const headerBytes = 64;
const headerSizeAt = 40; // u64: bytes of the file
const headerKindAt = 48; // u64: 0 a surface, 1 a scene
const directoryTail = 64 << 10; // before the directory lies the base page: mostly they come together
const openAttempts = 4;

let module: Module;
let fetcher: PageFetcher;
let lostPages = 0;
let damageTold = false;

function post(message: FromWorker, transfer: Transferable[] = []) {
  (self as unknown as Worker).postMessage(message, transfer);
}

const events = {
  arrived(page: number, stored: Uint8Array) {
    module.bring(page, stored);
    post({ kind: 'arrived' });
  },
  lost(page: number, why: string) {
    module.giveUp(page, why);
    ++lostPages;
    post({ kind: 'failed', message: why });
  },
  trouble(message: string) {
    post({ kind: 'trouble', message });
  },
};

async function open(message: Extract<ToWorker, { kind: 'open' }>) {
  const source = typeof message.source === 'string' ? new HttpSource(message.source) : new BlobSource(message.source);
  fetcher = new PageFetcher(source, new AbortController().signal, events);
  const [header, loaded] = await Promise.all([
    fetcher.read(0, headerBytes, openAttempts),
    Module.load(factory as Factory, message.wasm),
  ]);
  module = loaded;
  module.create(message.name, source.size() ?? announcedSize(header), header[headerKindAt] === 1);
  module.deliver(0, header);
  let held: Piece = { begin: Infinity, bytes: new Uint8Array() };
  for (let tail = directoryTail; ; tail = 0) {
    const facts = module.open(message.cacheBytes);
    if (!Array.isArray(facts)) {
      const shaders = { clipControl: module.shaders(false), fragmentDepth: module.shaders(true) };
      post({ kind: 'opened', facts, shaders });
      return;
    }
    held = await before(held, Math.max(headerBytes, facts[0] - tail), facts[0] + facts[1]);
    module.deliver(held.begin, held.bytes);
  }
}

interface Piece {
  begin: number;
  bytes: Uint8Array;
}

/** From `begin` to `end`; what is held of it is not fetched again. */
async function before(held: Piece, begin: number, end: number): Promise<Piece> {
  const joins = begin < held.begin && held.begin < end;
  const fetched = await fetcher.read(begin, (joins ? held.begin : end) - begin, openAttempts);
  if (!joins) return { begin, bytes: fetched };
  const bytes = new Uint8Array(fetched.length + held.bytes.length);
  bytes.set(fetched);
  bytes.set(held.bytes, fetched.length);
  return { begin, bytes };
}

function announcedSize(header: Uint8Array): number {
  if (header.length < headerBytes) return header.length;
  return Number(new DataView(header.buffer, header.byteOffset).getBigUint64(headerSizeAt, true));
}

function step(numbers: number[]) {
  const { report, words } = module.step(numbers);
  fetcher.ask(module.takeAsked());
  tellDamage(report.failedPages);
  const traffic = {
    requests: fetcher.requests,
    bytes: fetcher.bytes,
    pages: fetcher.pages,
    active: fetcher.active,
    memoryBytes: module.memoryBytes(),
  };
  post({ kind: 'stepped', report, words, traffic }, [words.buffer]);
}

/** Of pages that came, but are not what the directory says. */
function tellDamage(failedPages: number) {
  if (failedPages <= lostPages || damageTold) return;
  damageTold = true;
  post({ kind: 'failed', message: module.firstError() });
}

function answer(message: Extract<ToWorker, { kind: 'ask' }>) {
  const { id, question, numbers } = message;
  if (question === 'firstView') post({ kind: 'answer', id, value: module.firstView(numbers) });
  if (question === 'distance') post({ kind: 'answer', id, value: module.distanceAlong(numbers) });
  if (question === 'place') post({ kind: 'answer', id, value: module.place(numbers) });
}

async function handle(message: ToWorker) {
  if (message.kind === 'open') await open(message);
  if (message.kind === 'step') step(message.numbers);
  if (message.kind === 'ask') answer(message);
}

self.onmessage = (event: MessageEvent<ToWorker>) => {
  handle(event.data).catch((error: Error) => post({ kind: 'failed', message: error.message }));
};
