// What a page transfers: node tests/web/measure.mjs FILE.cuesta [TAU] → bytes and milliseconds to the first picture, to rest
// at TAU (2 px), and over a flight around the model and near it (20 s), 1280 × 720, as one line of JSON each.

import { basename, dirname, join, resolve } from 'node:path';
import { launch, missing, web } from './chromium.mjs';
import { serve } from './range_server.mjs';

const lacking = missing();
if (lacking || !process.argv[2]) {
  console.error(lacking ? `measure: ${lacking} is not there` : 'usage: node tests/web/measure.mjs FILE.cuesta [TAU]');
  process.exit(1);
}
const file = resolve(process.argv[2]);
const tau = Number(process.argv[3] ?? 2);
const host = await serve({ '/': join(web, 'page'), '/data/': dirname(file) });
const browser = await launch();
const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
await page.goto(`http://127.0.0.1:${host.port}/?data=/data/${basename(file)}#tau=${tau}`);

const state = () =>
  page.evaluate(async () => {
    const { viewer: v } = await import('/page.js');
    if (!v?.settled) return null;
    const { report, traffic, firstBytes, firstMs, surface } = v;
    const { triangles, achieved, residentBytes } = report;
    return { fileBytes: surface.facts.bytes, firstBytes, firstMs, triangles, achieved, residentBytes, ...traffic };
  });

async function settled() {
  for (;;) {
    const now = await state();
    if (now) return now;
    await page.waitForTimeout(100);
  }
}

const told = (what, numbers) => console.log(JSON.stringify({ what, ...numbers }));
told('at rest', await settled());
const worst = await page.evaluate(async () => {
  const { viewer } = await import('/page.js');
  const { eye, target } = viewer.view;
  const worst = { frames: 0, steps: 0, adaptMs: 0, triangles: 0, residentBytes: 0 };
  viewer.onStep = () => {
    ++worst.steps;
    for (const k of ['adaptMs', 'triangles', 'residentBytes']) worst[k] = Math.max(worst[k], viewer.report[k]);
  };
  const ms = 20_000;
  const start = performance.now();
  for (let u = 0; u < 1; u = (performance.now() - start) / ms) {
    const near = 1 - 0.85 * Math.sin(Math.PI * u);
    const [c, s] = [Math.cos(2 * Math.PI * u), Math.sin(2 * Math.PI * u)];
    const [x, y, z] = eye.map((e, k) => (e - target[k]) * near);
    viewer.view = { ...viewer.view, eye: [target[0] + x * c + z * s, target[1] + y, target[2] + z * c - x * s] };
    ++worst.frames;
    await new Promise(requestAnimationFrame);
  }
  return worst;
});
told('flight, at most', worst);
told('after the flight', await settled());
await browser.close();
host.close();
