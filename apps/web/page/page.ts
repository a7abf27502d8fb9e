// The page: what the address says is opened; panel, tools and keys; the address follows the view.

import type { Source } from '../client/index.ts';
import { type PageState, read, written } from './link.ts';
import { Viewer } from './viewer.ts';

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const input = (id: string) => element<HTMLInputElement>(id);
const canvas = element<HTMLCanvasElement>('canvas');
const isSmall = matchMedia('(max-width: 40rem)').matches;
const noteMs = 4000;

const usual: PageState = {
  tau: 1,
  triangles: isSmall ? 1e6 : 10 ** 6.5,
  memoryMiB: isSmall ? 128 : 256,
  exaggeration: 1,
  shading: 'usual',
  geomorphMs: 0,
};

/** Of this page, once a file is open. */
export let viewer: Viewer | null = null;
let opened: Source | null = null;
let state: PageState = read(location.hash, usual, innerWidth, innerHeight);

function tell(message: string) {
  element('message').textContent = message;
  element('message').hidden = message === '';
}

let noteTimer = 0;
function note(text: string, ms = noteMs) {
  element('note').textContent = text;
  clearTimeout(noteTimer);
  if (text && ms > 0) noteTimer = window.setTimeout(() => note(''), ms);
}

const counted = (n: number) => Math.round(n).toLocaleString('en');
const bytes = (n: number) =>
  n < 1 << 20 ? `${(n / 1024).toFixed(0)} KiB` : n < 1 << 30 ? `${(n / (1 << 20)).toFixed(1)} MiB` : `${(n / (1 << 30)).toFixed(2)} GiB`;

function showStatistics() {
  const { report: r, traffic: t, surface, renderer } = viewer!;
  if (!r || !t || !element<HTMLDetailsElement>('settings').open) return;
  const rows: [string, string][] = [
    ['Triangles', counted(r.triangles)],
    ['of', counted(surface.facts.triangles)],
    ...(surface.facts.scene ? [] : ([['Error', isFinite(r.achieved) ? `${r.achieved.toPrecision(3)} px` : '…']] as [string, string][])),
    [surface.facts.scene ? 'Objects' : 'Pages', `${r.residentPages}${r.pagesMissing ? `, ${r.pagesMissing} missing` : ''}`],
    ['Step', `${r.adaptMs.toFixed(1)} ms`],
    [surface.facts.scene ? 'Parts take' : 'Pages take', bytes(r.residentBytes)],
    ['Module', bytes(t.memoryBytes)],
    ['GPU', bytes(renderer.bytes)],
    ['Fetched', bytes(t.bytes)],
    ['of', bytes(surface.facts.bytes)],
    ['Requests', `${t.requests}${t.active ? `, ${t.active} now` : ''}`],
    ['Bound by', r.boundBy],
  ];
  element('statistics').replaceChildren(
    ...rows.flatMap(([name, value]) => {
      const [term, detail] = [document.createElement('dt'), document.createElement('dd')];
      [term.textContent, detail.textContent] = [name, value];
      return [term, detail];
    }),
  );
}

/** The sliders' numbers are exponents. */
function showSettings() {
  input('tau').valueAsNumber = Math.log2(state.tau);
  input('triangles').valueAsNumber = Math.log10(state.triangles);
  input('memory').valueAsNumber = Math.log2(state.memoryMiB);
  input('exaggeration').valueAsNumber = Math.log2(state.exaggeration);
  input('blend').checked = state.geomorphMs > 0;
  element<HTMLSelectElement>('shading').value = state.shading;
  element('tauText').textContent = `${Number(state.tau.toPrecision(2))} px`;
  element('trianglesText').textContent = counted(state.triangles);
  element('memoryText').textContent = `${state.memoryMiB} MiB`;
  element('exaggerationText').textContent = `× ${Number(state.exaggeration.toPrecision(2))}`;
}

function applySettings() {
  const { aim, options } = viewer!;
  aim.tau = state.tau;
  aim.triangles = state.triangles;
  aim.exaggeration = state.exaggeration;
  aim.geomorphMs = state.geomorphMs;
  options.shading = state.shading === 'usual' ? undefined : (state.shading as typeof options.shading);
  viewer!.changed();
  showSettings();
  keepLink();
}

function change(part: Partial<PageState>) {
  state = { ...state, ...part };
  if (viewer) applySettings();
}

let linkTimer = 0;
function keepLink() {
  clearTimeout(linkTimer);
  linkTimer = window.setTimeout(() => {
    if (viewer) history.replaceState(null, '', `#${written({ ...state, view: viewer.view })}`);
  }, 250);
}

/** Memory is taken when a file is opened. */
function changeMemory(memoryMiB: number) {
  if (!viewer || !opened) return;
  state = { ...state, memoryMiB, view: viewer.view };
  viewer.close();
  viewer = null;
  void open(opened);
}

async function open(source: Source) {
  opened = source;
  element('chooser').hidden = true;
  tell('');
  note('Opening…', 0);
  const name = typeof source === 'string' ? (source.split(/[?#]/)[0].split('/').pop() ?? source) : (source as File).name;
  try {
    viewer = await Viewer.open(canvas, source, state.memoryMiB * 2 ** 20, state.view);
  } catch (error) {
    note('');
    tell((error as Error).message);
    return;
  }
  note('');
  document.title = `${name} – Cuesta`;
  element('title').textContent = name;
  element('heights').hidden = !viewer.surface.facts.relief;
  for (const option of element<HTMLSelectElement>('shading').options)
    option.disabled = !!viewer.surface.facts.scene && ['pages', 'levels'].includes(option.value);
  element('panel').hidden = element('tools').hidden = false;
  element<HTMLDetailsElement>('settings').open = !isSmall;
  viewer.surface.onTrouble = (message) => note(message, 0);
  viewer.surface.onFailure = (message) => note(`${message} What is there stays, coarser.`, 0);
  viewer.onStep = showStatistics;
  viewer.onMove = keepLink;
  applySettings();
  canvas.focus({ preventScroll: true, focusVisible: false } as FocusOptions);
}

function setMode() {
  if (!viewer) return;
  const fly = viewer.controls.mode !== 'fly';
  viewer.controls.setMode(fly ? 'fly' : 'orbit');
  element('mode').setAttribute('aria-pressed', String(fly));
  note(fly ? 'Fly: W A S D, Q and E move, drag looks around.' : 'Orbit: drag turns.');
}

async function savePicture() {
  const blob = await viewer?.picture();
  if (!blob) return;
  const a = document.createElement('a');
  a.href = URL.createObjectURL(blob);
  a.download = `${document.title.split(' – ')[0].replace(/\.cuesta$/, '')}.png`;
  a.click();
  URL.revokeObjectURL(a.href);
}

async function copyLink() {
  if (!viewer) return;
  const link = new URL(location.href);
  link.hash = written({ ...state, view: viewer.view });
  history.replaceState(null, '', link);
  try {
    await navigator.clipboard.writeText(link.href);
    note('The link is copied.');
  } catch {
    note('The link is in the address bar.');
  }
}

const actions: Record<string, () => void> = {
  fit: () => void viewer?.fit(),
  mode: setMode,
  picture: () => void savePicture(),
  link: () => void copyLink(),
  help: () => element<HTMLDialogElement>('helpText').showModal(),
};
for (const [id, act] of Object.entries(actions)) element(id).addEventListener('click', act);

const keys: Record<string, () => void> = {
  f: actions.fit,
  Home: actions.fit,
  m: actions.mode,
  p: actions.picture,
  l: actions.link,
  '?': actions.help,
  F1: actions.help,
  '[': () => change({ tau: Math.max(0.25, state.tau / 1.1892) }),
  ']': () => change({ tau: Math.min(32, state.tau * 1.1892) }),
};
addEventListener('keydown', (event) => {
  const typing = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
  if (typing || event.ctrlKey || event.metaKey || event.altKey || !viewer) return;
  const act = keys[event.key];
  if (act) (act(), event.preventDefault());
});

input('tau').oninput = () => change({ tau: 2 ** input('tau').valueAsNumber });
input('triangles').oninput = () => change({ triangles: Math.round(10 ** input('triangles').valueAsNumber) });
input('memory').oninput = () => (element('memoryText').textContent = `${2 ** input('memory').valueAsNumber} MiB`);
input('memory').onchange = () => changeMemory(2 ** input('memory').valueAsNumber);
input('exaggeration').oninput = () => change({ exaggeration: 2 ** input('exaggeration').valueAsNumber });
input('blend').onchange = () => change({ geomorphMs: input('blend').checked ? 250 : 0 });
element<HTMLSelectElement>('shading').onchange = () => change({ shading: element<HTMLSelectElement>('shading').value });
element('settings').addEventListener('toggle', () => viewer && showStatistics());
addEventListener('hashchange', () => {
  if (!viewer) return;
  state = read(location.hash, usual, viewer.view.width, viewer.view.height);
  if (state.view) viewer.view = state.view;
  applySettings();
});
canvas.addEventListener('webglcontextlost', () => tell('The browser took the graphics away: reload the page.'));

const chooser = element<HTMLFormElement>('chooser');
chooser.onsubmit = (event) => {
  event.preventDefault();
  const file = input('file').files?.[0];
  const address = input('address').value;
  if (file) void open(file);
  else if (address) location.search = new URLSearchParams({ data: address }).toString();
};

const asked = new URLSearchParams(location.search).get('data');
if (asked) void open(asked);
else chooser.hidden = false;
