// Brings pages: the most urgent first, neighbours in the file together, several requests at a time.

import { type ByteSource, readPatiently } from './byte_source.ts';

export interface AskedPage {
  page: number;
  offset: number;
  bytes: number;
}

const mostRequests = 6; // what a browser opens to one host by HTTP/1.1
const largestRequest = 512 << 10;
const largestGap = 8 << 10; // rather read than asked for apart
const attempts = 1000;

/** Of `queue`, the first page and what lies beside it in the file; taken out. Ascending. */
export function takeNeighbours(queue: AskedPage[]): AskedPage[] {
  const taken = queue.splice(0, 1);
  let begin = taken[0].offset;
  let end = begin + taken[0].bytes;
  for (let grown = true; grown; ) {
    grown = false;
    for (let i = 0; i < queue.length; ++i) {
      const q = queue[i];
      const from = Math.min(begin, q.offset);
      const to = Math.max(end, q.offset + q.bytes);
      const near = q.offset <= end + largestGap && q.offset + q.bytes >= begin - largestGap;
      if (!near || to - from > largestRequest) continue;
      taken.push(...queue.splice(i--, 1));
      [begin, end, grown] = [from, to, true];
    }
  }
  return taken.sort((a, b) => a.offset - b.offset);
}

export interface FetcherEvents {
  arrived(page: number, stored: Uint8Array): void;
  /** No page will come any more. */
  lost(page: number, why: string): void;
  trouble(message: string): void;
}

export class PageFetcher {
  requests = 0;
  bytes = 0;
  pages = 0;
  active = 0;
  private readonly queue: AskedPage[] = [];

  constructor(
    private readonly source: ByteSource,
    private readonly signal: AbortSignal,
    private readonly events: FetcherEvents,
  ) {}

  ask(pages: AskedPage[]) {
    this.queue.push(...pages);
    while (this.active < mostRequests && this.queue.length > 0) void this.bring(takeNeighbours(this.queue));
  }

  private async bring(pages: AskedPage[]) {
    const begin = pages[0].offset;
    const last = pages[pages.length - 1];
    ++this.active;
    try {
      const bytes = await this.read(begin, last.offset + last.bytes - begin, attempts);
      for (const p of pages) {
        this.events.arrived(p.page, bytes.subarray(p.offset - begin, p.offset - begin + p.bytes));
        ++this.pages;
        await breath();
      }
    } catch (error) {
      if (!this.signal.aborted) for (const p of pages) this.events.lost(p.page, (error as Error).message);
    } finally {
      --this.active;
    }
    if (!this.signal.aborted) this.ask([]);
  }

  /** Counted, and patient. */
  async read(offset: number, bytes: number, patience: number): Promise<Uint8Array> {
    ++this.requests;
    const read = await readPatiently(this.source, offset, bytes, this.signal, patience, (m) => this.events.trouble(m));
    this.bytes += read.byteLength;
    return read;
  }
}

/** Lets what waits for this thread go first: a page takes a frame's time to decode. */
function breath(): Promise<void> {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => (port1.close(), resolve());
    port2.postMessage(0);
  });
}
