// A static host for tests: folders by prefix, single ranges, ETag; what a request asks for is counted. Faults are switched
// on by the tests that are about them.

import { createReadStream, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';

const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };

/** @param folders  prefix → folder, as { '/data/': '/somewhere' }. */
export async function serve(folders) {
  const host = {
    requests: [], // { path, range, bytes }
    faults: {}, // ignoreRange, etag, status: of files under /data/
    port: 0,
    close: () => server.close(),
  };
  const server = createServer((request, response) => answer(host, folders, request, response));
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  host.port = server.address().port;
  return host;
}

function locate(folders, path) {
  const prefix = Object.keys(folders)
    .filter((p) => path.startsWith(p))
    .sort((a, b) => b.length - a.length)[0];
  return prefix && join(folders[prefix], normalize(`/${path.slice(prefix.length)}`));
}

function answer(host, folders, request, response) {
  const path = decodeURIComponent(new URL(request.url, 'http://host').pathname);
  const file = locate(folders, path.endsWith('/') ? `${path}index.html` : path);
  const status = file && statSync(file, { throwIfNoEntry: false });
  if (!status?.isFile()) return void response.writeHead(404).end();
  const isData = path.startsWith('/data/');
  const faults = isData ? host.faults : {};
  if (faults.status) return void response.writeHead(faults.status).end();
  const headers = {
    'Content-Type': types[extname(file)] ?? 'application/octet-stream',
    'Accept-Ranges': 'bytes',
    ETag: faults.etag ?? `"${status.size}-${status.mtimeMs}"`,
  };
  const range = faults.ignoreRange ? null : /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
  const begin = range ? Number(range[1]) : 0;
  const end = Math.min(status.size - 1, range ? Number(range[2]) : status.size);
  host.requests.push({ path, range: range?.[0] ?? null, bytes: end - begin + 1 });
  if (range) headers['Content-Range'] = `bytes ${begin}-${end}/${status.size}`;
  headers['Content-Length'] = end - begin + 1;
  response.writeHead(range ? 206 : 200, headers);
  createReadStream(file, { start: begin, end }).pipe(response);
}
