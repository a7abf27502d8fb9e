// What is looked at, built here: a bumpy ring as a scan, a globe of made-up land and sea; and where shared data are beside
// the checkout, the Earth of ETOPO5 and a scene, an engine of 67 instances of 29 parts.

import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gunzipSync } from 'node:zlib';

const shared = fileURLToPath(new URL('../../../shared/data/', import.meta.url));

/** Nothing where the data are not there. */
export function buildScene(cuesta, folder) {
  const input = join(shared, 'scene/2CylinderEngine.glb');
  if (!existsSync(input)) return undefined;
  execFileSync(cuesta, ['build', input, '--type', 'scene', '-o', join(folder, 'engine.cuesta'), '--quiet']);
  return 'engine.cuesta';
}

/** Every fourth height of ETOPO5, on the ellipsoid. Nothing where the data are not there. */
export function buildEarth(cuesta, folder) {
  const input = join(shared, 'dem/etopo5.cdf.gz');
  if (!existsSync(input)) return undefined;
  const file = gunzipSync(readFileSync(input));
  const [columns, rows, heightsAt, every] = [4320, 2161, 0xcd48, 4]; // f32, big-endian, from the south, from 0° to the east
  const lines = [
    `ncols ${columns / every}`,
    `nrows ${(rows - 1) / every + 1}`,
    'xllcenter -180',
    'yllcenter -90',
    `cellsize ${every / 12}`,
    'NODATA_value -32768',
  ];
  for (let j = rows - 1; j >= 0; j -= every) {
    const row = [];
    for (let i = 0; i < columns; i += every)
      row.push(Math.round(file.readFloatBE(heightsAt + 4 * (j * columns + ((i + columns / 2) % columns)))));
    lines.push(row.join(' '));
  }
  writeFileSync(join(folder, 'earth.asc'), lines.join('\n'));
  return built(cuesta, folder, 'earth.asc', 'earth.cuesta', '--crs', 'EPSG:4326', '--frame', 'ecef');
}

export function buildScan(cuesta, folder) {
  const [around, along] = [160, 900];
  const point = (i, j) => {
    const t = (2 * Math.PI * j) / along;
    const s = (2 * Math.PI * i) / around;
    const r = 0.55 + 0.03 * Math.sin(9 * s + 31 * t) + 0.012 * Math.sin(23 * s - 113 * t);
    const reach = 2 + 0.3 * Math.cos(5 * t) + r * Math.cos(s);
    return [reach * Math.cos(t), 0.4 * Math.sin(3 * t) + r * Math.sin(s), -reach * Math.sin(t)];
  };
  const lines = [];
  for (let j = 0; j < along; ++j) for (let i = 0; i < around; ++i) lines.push(`v ${point(i, j).join(' ')}`);
  const id = (i, j) => 1 + (i % around) + around * (j % along);
  for (let j = 0; j < along; ++j)
    for (let i = 0; i < around; ++i) {
      lines.push(`f ${id(i, j)} ${id(i, j + 1)} ${id(i + 1, j + 1)}`, `f ${id(i, j)} ${id(i + 1, j + 1)} ${id(i + 1, j)}`);
    }
  writeFileSync(join(folder, 'ring.obj'), lines.join('\n'));
  return built(cuesta, folder, 'ring.obj', 'ring.cuesta');
}

export function buildTerrain(cuesta, folder) {
  const [columns, rows] = [720, 360];
  const rowsOfText = [`ncols ${columns}`, `nrows ${rows}`, 'xllcorner -180', 'yllcorner -90', 'cellsize 0.5', 'NODATA_value -32768'];
  for (let j = 0; j < rows; ++j) {
    const lat = (Math.PI * (90 - 0.25 - 0.5 * j)) / 180;
    const row = [];
    for (let i = 0; i < columns; ++i) {
      const lon = (Math.PI * (0.25 + 0.5 * i)) / 180;
      const [x, y, z] = [Math.cos(lat) * Math.cos(lon), Math.cos(lat) * Math.sin(lon), Math.sin(lat)];
      let h = 0;
      for (let k = 0, f = 2.1, a = 2600; k < 6; ++k, f *= 2.03, a /= 1.9)
        h += a * Math.sin(f * x + k) * Math.cos(f * 1.1 * y - 2 * k) + a * 0.6 * Math.sin(f * 1.3 * z + 3 * k);
      row.push(Math.round(h - 400));
    }
    rowsOfText.push(row.join(' '));
  }
  writeFileSync(join(folder, 'globe.asc'), rowsOfText.join('\n'));
  return built(cuesta, folder, 'globe.asc', 'globe.cuesta', '--crs', 'EPSG:4326', '--frame', 'ecef');
}

function built(cuesta, folder, input, output, ...options) {
  execFileSync(cuesta, ['build', join(folder, input), '-o', join(folder, output), '--quiet', ...options]);
  return output;
}
