// Our tiles in the clients that people have, headless: CesiumJS, and three.js with 3d-tiles-renderer; exported to a static
// host, and live from `cuesta serve`, which is another origin than the page's. By the environment:
//   CUESTA_EXECUTABLE, CUESTA_MAKE_SCAN, CUESTA_MAKE_TERRAIN    programs
//   CUESTA_CLIENTS_OUT                                          folder for pictures to look at; default: a temporary one
// Ends with 77, "skipped", where something is missing.

import assert from 'node:assert/strict';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { launch, missingBrowser } from '../web/chromium.mjs';
import { host } from './host.mjs';
import { make, names, placed, programs, sampled, serveLive, tilesOf } from './inputs.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const packages = join(here, 'node_modules');
const lacking =
  Object.keys(programs).find((p) => !existsSync(programs[p] ?? '')) ??
  (existsSync(join(packages, 'cesium')) ? missingBrowser() : 'tests/clients/node_modules (tools/test --web)');
if (lacking) {
  console.log(`skipped: ${lacking} is not there`);
  process.exit(77);
}

const folder = mkdtempSync(join(tmpdir(), 'cuesta-clients-'));
const out = process.env.CUESTA_CLIENTS_OUT ?? folder;
const patience = 300_000; // milliseconds: software rendering on a busy machine
const shown = { exported: names, live: ['scan', 'hills'] }; // the live files are those of an export: one frame will do
const shownTerrain = { exported: 'globe', live: 'hills' };
let statics;
let live;
let browser;

before(async () => {
  mkdirSync(out, { recursive: true });
  make(folder);
  statics = await host({
    '/': here,
    '/cesium/': join(packages, 'cesium/Build/Cesium'),
    '/packages/': packages,
    '/tiles/': join(folder, 'tiles'),
    '/terrain/': join(folder, 'terrain'),
  });
  live = await serveLive(folder);
  browser = await launch();
});

after(async () => {
  await browser?.close();
  live?.close();
  statics?.close();
  rmSync(folder, { recursive: true, force: true });
});

const tileAddress = (source, kind, name) => `${(source === 'live' ? live : statics).address}/${kind}/${name}`;

/** A tab with a client's page. What it complains about or does not get fails the test. */
async function visit(t, file) {
  const context = await browser.newContext({ viewport: { width: 480, height: 320 } });
  const page = await context.newPage();
  const complaints = [];
  page.tiles = new Set(); // addresses that were answered
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('console', (m) => m.type() === 'error' && complaints.push(m.text()));
  page.on('response', (r) => {
    if (r.status() >= 400) complaints.push(`${r.status()} ${r.url()}`);
    if (/\.(glb|terrain)$/.test(new URL(r.url()).pathname)) page.tiles.add(r.url());
  });
  t.after(async () => {
    const failures = await page.evaluate(() => window.failures);
    await context.close();
    assert.deepEqual([...complaints, ...failures], []);
  });
  page.setDefaultTimeout(patience);
  await page.goto(`${statics.address}/${file}`);
  await page.waitForFunction(() => window.failures);
  return page;
}

/** How far below the root the finest tile is that a client has asked for. */
const depth = (page) => Math.max(...[...page.tiles].map((url) => /\/t(\d*)-\d+\.glb$/.exec(url)[1].length));
const level = (page) => Math.max(...[...page.tiles].map((url) => Number(/\/(\d+)\/\d+\/\d+\.terrain$/.exec(url)[1])));

/** Places inside the terrain, away from its edge. */
const places = [];
for (let i = 0; i < 4; ++i)
  for (let k = 0; k < 4; ++k) places.push([27.985 + 0.0257 * i + 0.0011 * k, 86.953 + 0.0291 * k + 0.0007 * i]);

function assertHeights(t, found, name, bound) {
  const differences = sampled(folder, name, places).map((h, i) => Math.abs(h - found[i]));
  t.diagnostic(`${name}: heights differ by ${Math.max(...differences).toFixed(3)} m at most, bound ${bound.toFixed(3)} m`);
  differences.forEach((d, i) => assert.ok(d <= bound, `${places[i]}: ${found[i]} m is ${d} m off`));
}

/** Far, then near: the client must have asked for finer tiles, and painted something. */
async function refines(page, look, finest, picture) {
  await look(false);
  const before = finest(page);
  await look(true);
  assert.ok(finest(page) > before, `level ${before} from afar, ${finest(page)} nearby`);
  const png = await page.screenshot({ path: join(out, `${picture}.png`) });
  assert.ok(png.length > 8000, `${picture} is empty: ${png.length} bytes`);
}

for (const client of ['cesium', 'three'])
  for (const source of Object.keys(shown))
    for (const name of shown[source])
      test(`3D Tiles of ${name}, ${source}, in ${client}`, async (t) => {
        const page = await visit(t, `${client}.html`);
        const onEarth = placed.includes(name);
        await page.evaluate(
          async ([url, earth]) => void (window.tiles = await window.openTiles(url, earth)),
          [`${tileAddress(source, 'tiles', name)}/tileset.json`, onEarth],
        );
        const look = (near) => page.evaluate((radii) => window.tiles.look(radii), near ? 1.3 : 60);
        await refines(page, look, depth, `${client}-${source}-${name}`);
        if (!onEarth) return;
        const heights = await page.evaluate((p) => window.tiles.heights(p), places);
        assertHeights(t, heights, name, tilesOf(folder, name).leafError);
      });

for (const [source, name] of Object.entries(shownTerrain))
  test(`quantized-mesh of ${name}, ${source}, in cesium`, async (t) => {
    const page = await visit(t, 'cesium.html');
    const hasNormals = await page.evaluate(async (url) => {
      window.terrain = await window.openTerrain(url);
      return window.terrain.hasNormals;
    }, tileAddress(source, 'terrain', name));
    assert.ok(hasNormals);
    const look = (near) =>
      page.evaluate((from_m) => window.terrain.look({ lat: 28.025, lon: 87, from_m }), near ? 9000 : 4e6);
    await refines(page, look, level, `cesium-terrain-${source}-${name}`);
    // The vertices' grid of 1 m.
    assertHeights(t, await page.evaluate((p) => window.terrain.heights(p), places), name, 0.866);
  });

test('contents are glTF without an error', async () => {
  const validator = createRequire(join(packages, 'x'))('gltf-validator');
  for (const name of names)
    for (const path of tilesOf(folder, name).contents) {
      const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(path)));
      assert.equal(issues.numErrors, 0, `${name}/${basename(path)}: ${JSON.stringify(issues.messages.slice(0, 3))}`);
    }
});
