// What clients are shown: a scan and terrain in two frames, made by our own tools, exported, and served live.

import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

const { CUESTA_EXECUTABLE: cuesta, CUESTA_MAKE_SCAN: makeScan, CUESTA_MAKE_TERRAIN: makeTerrain } = process.env;

export const programs = { CUESTA_EXECUTABLE: cuesta, CUESTA_MAKE_SCAN: makeScan, CUESTA_MAKE_TERRAIN: makeTerrain };
export const placed = ['hills', 'globe']; // terrain: in a projection, in ECEF
export const names = ['scan', ...placed];

const run = (program, ...args) => execFileSync(program, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });

/** A ring of a few quads, for the scan generator to smooth and to roughen. */
function writeRing(path) {
  const [around, along] = [8, 20];
  const lines = [];
  for (let j = 0; j < along; ++j)
    for (let i = 0; i < around; ++i) {
      const [t, s] = [(2 * Math.PI * j) / along, (2 * Math.PI * i) / around];
      const reach = 2 + 0.3 * Math.cos(5 * t) + 0.6 * Math.cos(s);
      lines.push(`v ${reach * Math.cos(t)} ${reach * Math.sin(t)} ${0.6 * Math.sin(s) + 0.3 * Math.sin(3 * t)}`);
    }
  const id = (i, j) => 1 + (i % around) + around * (j % along);
  for (let j = 0; j < along; ++j)
    for (let i = 0; i < around; ++i)
      lines.push(`f ${id(i, j)} ${id(i, j + 1)} ${id(i + 1, j + 1)}`, `f ${id(i, j)} ${id(i + 1, j + 1)} ${id(i + 1, j)}`);
  writeFileSync(path, lines.join('\n'));
}

/** `folder`/served/NAME.cuesta, and their exports: tiles/NAME, terrain/NAME. */
export function make(folder) {
  for (const name of ['served', 'tiles', 'terrain']) mkdirSync(join(folder, name), { recursive: true });
  const at = (name) => join(folder, name);
  const built = (input, name, ...options) =>
    run(cuesta, 'build', at(input), '-o', at(`served/${name}.cuesta`), '--quiet', ...options);
  writeRing(at('ring.obj'));
  run(makeScan, at('ring.obj'), at('scan.ply'), '--triangles', '300000');
  built('scan.ply', 'scan');
  run(makeTerrain, '--side', '385', '--roughness', '0.3', at('hills.i16'));
  built('hills.i16', 'hills');
  built('hills.i16', 'globe', '--frame', 'ecef');
  for (const name of names)
    run(cuesta, 'export', at(`served/${name}.cuesta`), '--format', '3dtiles', '-o', at(`tiles/${name}`), '--quiet');
  for (const name of placed)
    run(cuesta, 'export', at(`served/${name}.cuesta`), '--format', 'quantized-mesh', '-o', at(`terrain/${name}`), '--quiet');
}

/** `cuesta serve` of the folder: { address, close }. */
export async function serveLive(folder) {
  const server = spawn(cuesta, ['serve', join(folder, 'served'), '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  for await (const line of createInterface(server.stdout)) {
    const address = /^(http:\S+)\/: /.exec(line)?.[1];
    if (address) return { address, close: () => server.kill('SIGTERM') };
  }
  throw new Error('the server did not start');
}

/** Heights of the file's own surface, in metres. @param places  [[lat, lon], …] */
export function sampled(folder, name, places) {
  const list = join(folder, `${name}.places`);
  writeFileSync(list, places.map((p) => p.join(' ')).join('\n'));
  const told = JSON.parse(run(cuesta, 'sample', join(folder, `served/${name}.cuesta`), '--from', list, '--json'));
  return told.points.map((p) => p.height_m);
}

/** Of an exported tileset: contents by name, and the largest bound of an error that a leaf has, in metres. */
export function tilesOf(folder, name) {
  const at = join(folder, 'tiles', name);
  const files = readdirSync(at);
  const leaves = [];
  const look = (tile) => {
    if (!tile.children && tile.content.uri.endsWith('.glb')) leaves.push(tile.geometricError);
    (tile.children ?? []).forEach(look);
  };
  files.filter((f) => f.endsWith('.json')).forEach((f) => look(JSON.parse(readFileSync(join(at, f))).root));
  return { contents: files.filter((f) => f.endsWith('.glb')).map((f) => join(at, f)), leafError: Math.max(...leaves) };
}
