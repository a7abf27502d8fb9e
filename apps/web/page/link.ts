// The part of the address behind #: a view and its settings, so that a link restores them.

import type { Vec3, View } from '../client/index.ts';

export interface PageState {
  view?: View;
  tau: number;
  triangles: number;
  memoryMiB: number;
  exaggeration: number;
  shading: string;
  geomorphMs: number;
}

const rounded = (n: number) => String(Number(n.toPrecision(10)));

export function written(state: PageState): string {
  const parts = new URLSearchParams();
  const v = state.view;
  if (v) {
    parts.set('eye', v.eye.map(rounded).join());
    parts.set('target', v.target.map(rounded).join());
    parts.set('up', v.up.map(rounded).join());
    parts.set('fov', rounded((v.fovY * 180) / Math.PI));
  }
  parts.set('tau', rounded(state.tau));
  parts.set('triangles', rounded(state.triangles));
  parts.set('memory', rounded(state.memoryMiB));
  if (state.exaggeration !== 1) parts.set('heights', rounded(state.exaggeration));
  if (state.shading !== 'usual') parts.set('colours', state.shading);
  if (state.geomorphMs > 0) parts.set('blend', rounded(state.geomorphMs));
  return parts.toString().replaceAll('%2C', ',');
}

/** What is missing or makes no sense is as `usual` has it. */
export function read(hash: string, usual: PageState, width: number, height: number): PageState {
  const parts = new URLSearchParams(hash.replace(/^#/, ''));
  const number = (name: string, least: number, most: number, otherwise: number) => {
    const n = Number(parts.get(name) ?? NaN);
    return n >= least && n <= most ? n : otherwise;
  };
  const vector = (name: string): Vec3 | null => {
    const n = (parts.get(name) ?? '').split(',').map(Number);
    return n.length === 3 && n.every(isFinite) && parts.has(name) ? (n as Vec3) : null;
  };
  const [eye, target, up] = [vector('eye'), vector('target'), vector('up')];
  const apart = eye && target && eye.some((c, i) => c !== target[i]);
  const shadings = ['usual', 'lit', 'normals', 'pages', 'levels', 'wireframe'];
  return {
    view:
      apart && up?.some((c) => c !== 0)
        ? { eye, target, up, fovY: (number('fov', 1, 150, 60) * Math.PI) / 180, width, height }
        : undefined,
    tau: number('tau', 0.05, 1000, usual.tau),
    triangles: number('triangles', 1000, 1e8, usual.triangles),
    memoryMiB: number('memory', 16, 3072, usual.memoryMiB),
    exaggeration: number('heights', 0.1, 100, usual.exaggeration),
    shading: shadings.find((s) => s === parts.get('colours')) ?? usual.shading,
    geomorphMs: number('blend', 0, 2000, usual.geomorphMs),
  };
}
