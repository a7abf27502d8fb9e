// The page and the package in headless Chromium, from a static host. What it needs comes by the environment:
//   CUESTA_EXECUTABLE, CUESTA_WEB (build/web)      the program and what tools/web built
//   CUESTA_WEB_OUT                                 folder for pictures to look at; default: a temporary one
// Ends with 77, "skipped", where chromium or the built page is missing.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { here, launch, missing, packages, web } from './chromium.mjs';
import { inked, ssim } from './compare.mjs';
import { buildEarth, buildScan, buildScene, buildTerrain } from './inputs.mjs';
import { serve } from './range_server.mjs';

const cuesta = process.env.CUESTA_EXECUTABLE;
const lacking = missing() ?? (existsSync(cuesta ?? '') ? undefined : 'the program (CUESTA_EXECUTABLE)');
if (lacking) {
  console.log(`skipped: ${lacking} is not there`);
  process.exit(77);
}

const folder = mkdtempSync(join(tmpdir(), 'cuesta-web-'));
const out = process.env.CUESTA_WEB_OUT ?? folder;
const patience = 60_000; // milliseconds: software rendering on a busy machine
const size = { width: 720, height: 450 };
let host;
let browser;
let scan;
let terrain;
let scene; // undefined where there are no shared data
let earth;

before(async () => {
  mkdirSync(out, { recursive: true });
  scan = buildScan(cuesta, folder);
  terrain = buildTerrain(cuesta, folder);
  scene = buildScene(cuesta, folder);
  earth = buildEarth(cuesta, folder);
  host = await serve({
    '/': join(web, 'page'),
    '/client/': join(web, 'client'),
    '/three/': join(packages, 'three'),
    '/test/': here,
    '/data/': folder,
  });
  browser = await launch();
});

after(async () => {
  await browser?.close();
  host?.close();
  rmSync(folder, { recursive: true, force: true });
});

/** A tab at an address of the host. What it complains about fails the test, but for `expected`. */
async function visit(t, address, options = {}, expected = /^$/) {
  const context = await browser.newContext({ viewport: size, ...options });
  const page = await context.newPage();
  const complaints = [];
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('console', (m) => ['error', 'warning'].includes(m.type()) && complaints.push(m.text()));
  t.after(async () => {
    await context.close();
    assert.deepEqual(complaints.filter((c) => !expected.test(c) && !/GL Driver Message/.test(c)), []);
  });
  page.setDefaultTimeout(patience);
  await page.goto(`${options.baseURL ?? `http://127.0.0.1:${host.port}`}${address}`);
  return page;
}

/** Asks until the answer is true. */
async function until(what, ask) {
  const start = Date.now();
  while (!(await ask())) {
    assert.ok(Date.now() - start < patience, `never: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

const settled = (page) =>
  until('settled', () => page.evaluate(async () => (await import('/page.js')).viewer?.settled ?? false));

const eyeOf = async (page) => (await facts(page)).view.eye.join();

/** Keys are held until the camera is elsewhere. */
async function movesBy(page, key) {
  const before = await eyeOf(page);
  await page.keyboard.down(key);
  await until(`moved by ${key}`, async () => (await eyeOf(page)) !== before);
  await page.keyboard.up(key);
}

const facts = (page) =>
  page.evaluate(async () => {
    const { viewer: v } = await import('/page.js');
    const { view, report, traffic, firstBytes, firstMs } = v;
    return { view, report, traffic, firstBytes, firstMs, gpuBytes: v.renderer.bytes, file: v.surface.facts };
  });

/** RGBA of what is drawn, rows from the top. */
async function drawn(page) {
  const { text, width, height } = await page.evaluate(async () => {
    const { viewer } = await import('/page.js');
    const pixels = viewer.pixels();
    let text = '';
    for (let i = 0; i < pixels.length; i += 8192) text += String.fromCharCode(...pixels.subarray(i, i + 8192));
    return { text: btoa(text), width: viewer.canvas.width, height: viewer.canvas.height };
  });
  const rows = Buffer.from(text, 'base64');
  const pixels = Buffer.alloc(rows.length);
  for (let y = 0; y < height; ++y) rows.copy(pixels, y * width * 4, (height - 1 - y) * width * 4, (height - y) * width * 4);
  return { pixels, width, height };
}

/** What the program draws of the same view, and how many triangles it says that takes. */
async function drawnNatively(page, file, view, tau, ...options) {
  const camera = ['eye', 'target', 'up'].map((k) => `${k} ${view[k].join(',')}`).join(' ');
  const png = join(folder, 'native.png');
  const said = execFileSync(
    cuesta,
    ['render', join(folder, file), '-o', png, '--tau', `${tau}`, '--camera', camera, '--quiet', '--context', 'osmesa'].concat(
      ['--size', `${view.width}x${view.height}`, '--fov', `${(view.fovY * 180) / Math.PI}`, ...options],
    ),
    { encoding: 'utf8' },
  );
  copyFileSync(png, join(out, `${[file, ...options].join('')}.native.png`));
  const text = await page.evaluate(async (address) => {
    const image = await createImageBitmap(await (await fetch(address)).blob());
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const data = context.getImageData(0, 0, image.width, image.height).data;
    let text = '';
    for (let i = 0; i < data.length; i += 8192) text += String.fromCharCode(...data.subarray(i, i + 8192));
    return btoa(text);
  }, '/data/native.png');
  return { pixels: Buffer.from(text, 'base64'), triangles: Number(/: ([\d,]+)/.exec(said)[1].replaceAll(',', '')) };
}

/** @param mostBytes  of the file, to the first picture: header, directory and base page. */
async function looksAsNatively(t, file, mostBytes) {
  const page = await visit(t, `/?data=/data/${file}`);
  await settled(page);
  writeFileSync(join(out, `${file}.page.png`), await page.screenshot());
  const { report, view, traffic, firstBytes, file: about } = await facts(page);
  const here = await drawn(page);
  const native = await drawnNatively(page, file, view, 1);
  const alike = ssim(here.pixels, native.pixels, here.width, here.height);
  t.diagnostic(`${file}: ${report.triangles} triangles, SSIM ${alike.toFixed(4)}; first picture ${firstBytes} bytes, ` +
    `settled ${traffic.bytes} of ${about.bytes}; module ${traffic.memoryBytes} bytes`);
  assert.equal(report.triangles, native.triangles, 'the same cut');
  assert.ok(inked(here.pixels) > 0.1, 'something is drawn');
  assert.ok(alike >= 0.98, `SSIM ${alike}`);
  assert.ok(firstBytes <= mostBytes, `${firstBytes} bytes to the first picture`);
  assert.ok(traffic.bytes <= about.bytes * 1.1, 'nothing is fetched twice');
  assert.ok(report.residentBytes <= 256 * 2 ** 20);
}

test('a scan is the native picture', (t) => looksAsNatively(t, scan, 300_000));
test('a terrain is the native picture', (t) => looksAsNatively(t, terrain, 400_000));
test('a scene is the native picture', (t) => (scene ? looksAsNatively(t, scene, 300_000) : t.skip('no shared data')));
test('the Earth is the native picture', (t) => (earth ? looksAsNatively(t, earth, 300_000) : t.skip('no shared data')));

test('the Earth refines under a wheel', async (t) => {
  if (!earth) return t.skip('no shared data');
  const page = await visit(t, `/?data=/data/${earth}#tau=2`);
  await settled(page);
  const far = await facts(page);
  await page.mouse.move(400, 200);
  for (let i = 0; i < 4; ++i) await page.mouse.wheel(0, -200);
  await settled(page);
  const near = await facts(page);
  assert.notDeepEqual(near.view.eye, far.view.eye);
  const here = await drawn(page);
  const native = await drawnNatively(page, earth, near.view, 2);
  writeFileSync(join(out, 'earth-near.png'), await page.screenshot());
  const alike = ssim(here.pixels, native.pixels, here.width, here.height);
  t.diagnostic(
    `Earth: ${far.report.triangles} triangles from afar, ${near.report.triangles} from near, SSIM ${alike.toFixed(4)}; ` +
      `${far.traffic.bytes}, then ${near.traffic.bytes} of ${near.file.bytes} bytes`,
  );
  assert.ok(near.traffic.bytes > far.traffic.bytes, 'pages for it are fetched');
  assert.ok(alike >= 0.98, `SSIM ${alike}`);
});

/** Round about the target, as near as `nearest` of the way in the middle; @returns the most of each number of the reports. */
const fly = (page, frames, nearest) =>
  page.evaluate(
    async ([frames, nearest]) => {
      const { viewer } = await import('/page.js');
      const start = viewer.view;
      const worst = { triangles: 0, residentBytes: 0, uploadBytes: 0 };
      const told = viewer.onStep;
      viewer.onStep = () => {
        for (const k of Object.keys(worst)) worst[k] = Math.max(worst[k], viewer.report[k]);
      };
      for (let i = 0; i < frames; ++i) {
        const near = 1 - (1 - nearest) * Math.sin((Math.PI * i) / (1.1 * frames));
        const turn = (3 * i) / frames;
        const arm = start.eye.map((c, k) => (c - start.target[k]) * near);
        const eye = [arm[0] * Math.cos(turn) + arm[2] * Math.sin(turn), arm[1], arm[2] * Math.cos(turn) - arm[0] * Math.sin(turn)];
        viewer.view = { ...viewer.view, eye: eye.map((c, k) => c + start.target[k]) };
        await new Promise(requestAnimationFrame);
      }
      viewer.onStep = told;
      return worst;
    },
    [frames, nearest],
  );

test('a flight through a scene refines, within its budgets', async (t) => {
  if (!scene) return t.skip('no shared data');
  const page = await visit(t, `/?data=/data/${scene}#memory=32&triangles=30000&tau=4`);
  await settled(page);
  const before = await facts(page);
  const flight = await fly(page, 60, 0.4);
  await page.evaluate(async () => {
    const { viewer } = await import('/page.js');
    viewer.aim.tau = 0.5;
    viewer.changed();
  });
  await settled(page);
  const after = await facts(page);
  t.diagnostic(
    `scene: ${before.report.triangles}, in flight at most ${flight.triangles}, then ${after.report.triangles} triangles; ` +
      `${flight.residentBytes} bytes of parts; ${before.firstBytes}, ${before.traffic.bytes}, ${after.traffic.bytes} of ` +
      `${after.file.bytes} bytes; module ${after.traffic.memoryBytes}`,
  );
  assert.ok(after.report.triangles > before.report.triangles, 'refined');
  assert.ok(Math.max(flight.triangles, after.report.triangles) <= 30_000);
  assert.ok(flight.residentBytes <= 32 * 2 ** 20);
  assert.ok(before.traffic.bytes < after.traffic.bytes, 'what the view needs is fetched');
  assert.ok(after.traffic.memoryBytes <= 128 * 2 ** 20, `module: ${after.traffic.memoryBytes}`);
  assert.equal(after.report.failedPages, 0);
  writeFileSync(join(out, 'scene-flight.png'), await page.screenshot());
});

for (const kind of ['scan', 'scene'])
  test(`edges of a ${kind} can be seen`, async (t) => {
    const file = kind === 'scan' ? scan : scene;
    if (!file) return t.skip('no shared data');
    const page = await visit(t, `/?data=/data/${file}#tau=6`);
    await settled(page);
    const plain = await drawn(page);
    await page.selectOption('#shading', 'wireframe');
    await settled(page);
    const edges = await drawn(page);
    const native = await drawnNatively(page, file, (await facts(page)).view, 6, '--shading', 'wireframe');
    writeFileSync(join(out, `${kind}-edges.png`), await page.screenshot());
    const [to, from] = [plain, edges].map((p) => ssim(p.pixels, native.pixels, p.width, p.height));
    t.diagnostic(`${kind}: SSIM with the native wireframe ${from.toFixed(3)}, without edges ${to.toFixed(3)}`);
    assert.ok(from > to + 0.02, 'it looks more like the native wireframe');
    assert.ok(ssim(plain.pixels, edges.pixels, edges.width, edges.height) < 0.98);
  });

test('a flight refines, within its budgets', async (t) => {
  const page = await visit(t, `/?data=/data/${scan}#memory=32&triangles=60000&blend=100`);
  await settled(page);
  const flight = await fly(page, 90, 0.1);
  await settled(page);
  const { report, traffic } = await facts(page);
  t.diagnostic(`flight: at most ${flight.triangles} triangles, ${flight.residentBytes} bytes of pages, module ${traffic.memoryBytes}`);
  assert.ok(flight.triangles <= 60_000);
  assert.ok(flight.residentBytes <= 32 * 2 ** 20);
  assert.ok(traffic.memoryBytes <= 96 * 2 ** 20, `module: ${traffic.memoryBytes}`);
  assert.equal(report.settled, true);
  writeFileSync(join(out, 'flight.png'), await page.screenshot());
});

test('plain nginx is host enough', async (t) => {
  const nginx = ['/usr/sbin/nginx', '/usr/bin/nginx'].find((p) => existsSync(p));
  if (!nginx) return t.skip('nginx is not there');
  const port = host.port + 1;
  const config = join(folder, 'nginx.conf');
  const temporary = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((n) => `${n}_temp_path ${folder}/${n};`).join('\n');
  writeFileSync(
    config,
    `daemon off; master_process off; pid ${folder}/nginx.pid; error_log stderr;
     events {}
     http {
       ${temporary}
       access_log off;
       types { text/html html; text/javascript js; text/css css; application/wasm wasm; }
       server { listen 127.0.0.1:${port}; root ${join(web, 'page')}; location /data/ { alias ${folder}/; } }
     }`,
  );
  const server = spawn(nginx, ['-c', config, '-e', 'stderr'], { stdio: 'ignore' });
  t.after(() => server.kill());
  await until('nginx answers', () => fetch(`http://127.0.0.1:${port}/`).then((r) => r.ok, () => false));
  const page = await visit(t, `/?data=/data/${scan}`, { baseURL: `http://127.0.0.1:${port}` });
  await settled(page);
  assert.ok(inked((await drawn(page)).pixels) > 0.1);
});

test('a link restores the view', async (t) => {
  const page = await visit(t, `/?data=/data/${scan}`);
  await settled(page);
  await page.mouse.move(500, 200);
  await page.mouse.down();
  await page.mouse.move(600, 240, { steps: 5 });
  await page.mouse.up();
  await page.mouse.wheel(0, -400);
  await page.selectOption('#shading', 'levels');
  await settled(page);
  await page.waitForTimeout(500);
  const first = await drawn(page);
  const link = page.url();
  assert.match(link, /eye=.*colours=levels/);
  const again = await visit(t, link.slice(link.indexOf('/?')));
  await settled(again);
  const second = await drawn(again);
  assert.ok(ssim(first.pixels, second.pixels, first.width, first.height) > 0.995);
  writeFileSync(join(out, 'levels.png'), await again.screenshot());
});

test('keys alone reach everything', async (t) => {
  const page = await visit(t, `/?data=/data/${scan}`);
  await settled(page);
  const reached = new Set();
  for (let i = 0; i < 16; ++i) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.tagName));
  }
  for (const id of ['canvas', 'tau', 'triangles', 'memory', 'shading', 'fit', 'mode', 'picture', 'link', 'help'])
    assert.ok(reached.has(id), `${id} is reached by Tab`);
  await page.focus('#canvas');
  await movesBy(page, 'ArrowLeft');
  await page.keyboard.press('m');
  await movesBy(page, 'w');
  await page.keyboard.press('?');
  assert.ok(await page.isVisible('#helpText'));
});

test('a phone: touch, and everything fits', async (t) => {
  const phone = { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true, deviceScaleFactor: 1.5 };
  const page = await visit(t, `/?data=/data/${terrain}#heights=8`, phone);
  await settled(page);
  writeFileSync(join(out, 'phone.png'), await page.screenshot());
  const boxes = await page.$$eval('#tools button, #panel', (all) => all.map((e) => e.getBoundingClientRect().toJSON()));
  for (const b of boxes) assert.ok(b.left >= 0 && b.right <= 390 && b.height >= 36, JSON.stringify(b));
  const session = await page.context().newCDPSession(page);
  const touch = (type, ...points) =>
    session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const distance = (v) => Math.hypot(...v.eye.map((c, i) => c - v.target[i]));
  const start = (await facts(page)).view;
  await touch('touchStart', [200, 400]);
  await touch('touchMove', [150, 420]);
  await touch('touchEnd');
  const turned = (await facts(page)).view;
  assert.notDeepEqual(turned.eye, start.eye);
  await touch('touchStart', [150, 400], [250, 400]);
  for (let i = 1; i <= 5; ++i) await touch('touchMove', [150 - 12 * i, 400], [250 + 12 * i, 400]);
  await touch('touchEnd');
  assert.ok(distance((await facts(page)).view) < 0.9 * distance(turned), 'a pinch zooms');
  await page.tap('#title');
  assert.ok(await page.isVisible('#tau'));
  writeFileSync(join(out, 'phone-panel.png'), await page.screenshot());
});

test('a file of the device', async (t) => {
  const page = await visit(t, '/');
  await page.setInputFiles('#file', join(folder, scan));
  await page.click('#chooser button');
  await settled(page);
  assert.ok(inked((await drawn(page)).pixels) > 0.1);
});

test('hosts that cannot serve it are named', async (t) => {
  const failed = /Failed to load resource/;
  const told = async (faults, file = scan) => {
    host.faults = faults;
    const page = await visit(t, `/?data=/data/${file}`, {}, failed);
    await page.waitForSelector('#message:not([hidden])');
    host.faults = {};
    return page.textContent('#message');
  };
  assert.match(await told({ ignoreRange: true }), /ignores range requests \(200 instead of 206\)/);
  assert.match(await told({}, 'nothing.cuesta'), /There is no .*nothing\.cuesta/);
  assert.match(await told({ status: 403 }), /answers 403/);
  assert.match(await told({}, 'ring.obj'), /not a \.cuesta file/);
});

test('a file that is replaced while it is open', async (t) => {
  const page = await visit(t, `/?data=/data/${scan}#tau=30`);
  await settled(page);
  host.faults = { etag: '"another"' };
  t.after(() => (host.faults = {}));
  await page.evaluate(async () => {
    const { viewer } = await import('/page.js');
    viewer.aim.tau = 0.5;
    viewer.changed();
  });
  await until('told', async () => /replaced on its host/.test(await page.textContent('#note')));
  assert.ok(inked((await drawn(page)).pixels) > 0.1, 'what is there stays');
});

test('a host that fails for a while', async (t) => {
  const page = await visit(t, `/?data=/data/${scan}#tau=30`, {}, /503/);
  await settled(page);
  host.faults = { status: 503 };
  await page.evaluate(async () => {
    const { viewer } = await import('/page.js');
    viewer.aim.tau = 0.5;
    viewer.changed();
  });
  await until('told', async () => /Trying again/.test(await page.textContent('#note')));
  host.faults = {};
  await settled(page);
  assert.equal((await facts(page)).report.failedPages, 0);
  assert.equal(await page.textContent('#note'), '');
});

test('an object of three.js', async (t) => {
  const page = await visit(t, `/test/three.html?file=/data/${scan}`);
  await until('settled', () => page.evaluate(() => globalThis.scene?.settled ?? false));
  const { triangles } = await page.evaluate(() => globalThis.scene);
  assert.ok(triangles > 1000, `${triangles} triangles`);
  const picture = join(out, 'three.png');
  writeFileSync(picture, await page.screenshot());
  assert.ok(readFileSync(picture).length > 20_000, 'it is not blank');
});
