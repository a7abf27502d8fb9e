// A static host as docs/export.md wants it: folders by prefix, quantized-mesh as the gzip that it is.

import { createReadStream, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';

const types = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.mjs': 'text/javascript',
  '.css': 'text/css',
  '.json': 'application/json',
  '.wasm': 'application/wasm',
  '.glb': 'model/gltf-binary',
  '.terrain': 'application/vnd.quantized-mesh',
};

/** @param folders  prefix → folder, as { '/cesium/': '/somewhere' }; the longest prefix counts. */
export async function host(folders) {
  const prefixes = Object.keys(folders).sort((a, b) => b.length - a.length);
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://host').pathname);
    const prefix = prefixes.find((p) => path.startsWith(p));
    const file = prefix && join(folders[prefix], normalize(`/${path.slice(prefix.length)}`));
    const status = file && statSync(file, { throwIfNoEntry: false });
    if (!status?.isFile()) return void response.writeHead(404).end();
    const headers = { 'Content-Type': types[extname(file)] ?? 'application/octet-stream', 'Content-Length': status.size };
    if (extname(file) === '.terrain') headers['Content-Encoding'] = 'gzip';
    response.writeHead(200, headers);
    createReadStream(file).pipe(response);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { address: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}
