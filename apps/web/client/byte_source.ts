// Ranges of a file: of any host that answers range requests, or of a file that the user chose.

export interface ByteSource {
  /** Exactly these bytes. Throws a SourceError, or what `signal` was aborted with. */
  read(offset: number, bytes: number, signal: AbortSignal): Promise<Uint8Array>;
  /** Bytes of the whole file, once something was read; nothing if the host does not tell. */
  size(): number | undefined;
}

/** Why bytes could not be had. `passing`: it is worth trying again. */
export class SourceError extends Error {
  constructor(
    message: string,
    readonly passing: boolean,
  ) {
    super(message);
  }
}

export class BlobSource implements ByteSource {
  constructor(private readonly blob: Blob) {}

  size() {
    return this.blob.size;
  }

  async read(offset: number, bytes: number): Promise<Uint8Array> {
    try {
      return new Uint8Array(await this.blob.slice(offset, offset + bytes).arrayBuffer());
    } catch {
      throw new SourceError('The file cannot be read any more: it was changed or removed. Open it again.', false);
    }
  }
}

/** All answers must be of one version of the file. That is seen in them, by ETag and size, and asked for in no request:
 *  If-Range and If-Match would need a permission of their own (a preflight) from each foreign host. */
export class HttpSource implements ByteSource {
  private etag: string | null = null;
  private total: number | undefined;
  // A browser's cache puts ranges of two versions together, and shows the first one's ETag for both.
  private cache: RequestCache = 'no-store';

  constructor(private readonly url: string) {}

  size() {
    return this.total;
  }

  async read(offset: number, bytes: number, signal: AbortSignal): Promise<Uint8Array> {
    const response = await this.ask(`bytes=${offset}-${offset + bytes - 1}`, signal);
    try {
      this.check(response, offset);
    } catch (error) {
      void response.body?.cancel();
      throw error;
    }
    const body = await response.arrayBuffer().catch(() => {
      signal.throwIfAborted();
      throw new SourceError('The connection was lost.', true);
    });
    if (body.byteLength < bytes && this.total !== undefined && offset + bytes <= this.total)
      throw new SourceError('The connection was lost in the middle of an answer.', true);
    return new Uint8Array(body);
  }

  private async ask(range: string, signal: AbortSignal): Promise<Response> {
    try {
      return await fetch(this.url, { headers: { Range: range }, cache: this.cache, signal });
    } catch {
      signal.throwIfAborted();
      throw new SourceError(`${this.url} cannot be reached, or its host does not allow other sites to read it (CORS).`, true);
    }
  }

  private check(response: Response, offset: number) {
    const { status } = response;
    if (status === 200)
      throw new SourceError(
        'The host ignores range requests (200 instead of 206), so only the whole file could be had. ' +
          'Put the file on a host that answers them.',
        false,
      );
    if (status === 416 || status === 412) throw replaced();
    if (status === 404 || status === 410) throw new SourceError(`There is no ${this.url} (${status}).`, false);
    if (status !== 206)
      throw new SourceError(
        `The host answers ${status} ${response.statusText}.`,
        status >= 500 || status === 429 || status === 408,
      );
    const encoding = response.headers.get('Content-Encoding');
    if (encoding && encoding !== 'identity')
      throw new SourceError(`The host compresses ranges (${encoding}): switch that off for .cuesta files.`, false);
    this.checkVersion(response, offset);
  }

  private checkVersion(response: Response, offset: number) {
    // Foreign hosts show these only if they expose them; checksums of pages tell then.
    const range = /^bytes (\d+)-\d+\/(\d+)$/.exec(response.headers.get('Content-Range') ?? '');
    const etag = response.headers.get('ETag');
    if (range && Number(range[1]) !== offset)
      throw new SourceError('The host answers with another range than was asked for.', false);
    const total = range ? Number(range[2]) : this.total;
    if ((this.etag !== null && etag !== null && etag !== this.etag) || (this.total ?? total) !== total) throw replaced();
    this.etag ??= etag;
    if (/\bimmutable\b/.test(response.headers.get('Cache-Control') ?? '')) this.cache = 'default';
    this.total = total;
  }
}

function replaced() {
  return new SourceError('The file was replaced on its host while it was open: reload the page to see the new one.', false);
}

/** Reads; what passes is tried again after a while that doubles, up to `attempts` times. */
export async function readPatiently(
  source: ByteSource,
  offset: number,
  bytes: number,
  signal: AbortSignal,
  attempts: number,
  tell: (trouble: string) => void,
): Promise<Uint8Array> {
  const first = 400; // milliseconds
  const longest = 15_000;
  for (let attempt = 1; ; ++attempt) {
    try {
      const read = await source.read(offset, bytes, signal);
      if (attempt > 1) tell('');
      return read;
    } catch (error) {
      if (!(error instanceof SourceError) || !error.passing || attempt >= attempts) throw error;
      tell(`${error.message} Trying again.`);
      await pause(Math.min(longest, first * 2 ** (attempt - 1)) * (0.75 + 0.5 * Math.random()), signal);
    }
  }
}

function pause(ms: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, ms);
    signal.addEventListener('abort', () => (clearTimeout(timer), reject(signal.reason)), { once: true });
  });
}
