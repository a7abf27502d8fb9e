// Bundles the package and the page: node build.mjs --module DIR --output DIR (tools/web calls it).

import { build } from 'esbuild';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const here = dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({ options: { module: { type: 'string' }, output: { type: 'string' } } });
const module = resolve(values.module);
const client = resolve(values.output, 'client');
const page = resolve(values.output, 'page');

const common = { bundle: true, format: 'esm', target: 'es2022', minify: true, legalComments: 'none', logLevel: 'warning' };

for (const folder of [client, page]) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
}
execFileSync(resolve(here, 'node_modules/.bin/tsc'), ['-p', here, '--outDir', resolve(client, 'types')], { stdio: 'inherit' });
rmSync(resolve(client, 'types/page'), { recursive: true });

// The client stays readable: who bundles it minifies it.
await build({ ...common, minify: false, entryPoints: [`${here}/client/index.ts`], outfile: `${client}/cuesta.js` });
await build({
  ...common,
  minify: false,
  entryPoints: [`${here}/client/three.ts`],
  outfile: `${client}/three.js`,
  external: ['three'],
});
for (const folder of [client, page]) {
  await build({
    ...common,
    entryPoints: [`${here}/client/worker.ts`],
    outfile: `${folder}/worker.js`,
    alias: { 'cuesta-module': `${module}/cuesta_web.js` },
  });
  cpSync(`${module}/cuesta_web.wasm`, `${folder}/cuesta.wasm`);
}
await build({ ...common, entryPoints: [`${here}/page/page.ts`], outfile: `${page}/page.js` });
for (const file of ['index.html', 'page.css']) cpSync(`${here}/page/${file}`, `${page}/${file}`);
cpSync(`${here}/client/package.json`, `${client}/package.json`);
cpSync(`${here}/client/README.md`, `${client}/README.md`);
const version = /project\(cuesta VERSION ([0-9.]+)/.exec(readFileSync(`${here}/../../CMakeLists.txt`, 'utf8'))[1];
const manifest = JSON.parse(readFileSync(`${client}/package.json`, 'utf8'));
writeFileSync(`${client}/package.json`, `${JSON.stringify({ ...manifest, version }, null, 2)}\n`);
