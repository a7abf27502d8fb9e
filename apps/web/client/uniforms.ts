// What the shaders need of a view and of a terrain, computed in f64: as camera_matrices.h, relief_uniforms.h and the
// native renderer do it, so that pictures agree.

import { frameOf } from './camera.ts';
import type { ReliefFacts, SurfaceFacts, Vec3, View } from './types.ts';
import { dot, normalized, scaled, sub } from './vec.ts';

const nearPlaneUnits = 0.5; // half a grid step: no two positions are nearer to each other

const linear = (c: number) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
export const linearOf = (srgb: Vec3): Vec3 => [linear(srgb[0] / 255), linear(srgb[1] / 255), linear(srgb[2] / 255)];

export interface Lighting {
  /** Multiplies the vertices' colours; sRGB bytes. */
  surfaceColour: Vec3;
  /** Towards the key light, in the camera's frame. */
  light: Vec3;
}

export const usualLighting: Lighting = { surfaceColour: [232, 226, 216], light: [-0.35, 0.55, 0.75] };

/** Numbers and vectors by the names that the shaders give them; 9 numbers are a matrix by rows. */
export interface Uniforms {
  ints: Record<string, number[]>;
  floats: Record<string, number[]>;
}

/** What does not depend on what is drawn. */
export function lightUniforms(view: View, lighting: Lighting): Record<string, number[]> {
  const focal = 1 / Math.tan(view.fovY / 2);
  const key = normalized(lighting.light);
  return {
    focal: [(focal * view.height) / view.width, focal],
    surface_colour: linearOf(lighting.surfaceColour),
    key_direction: key,
    fill_direction: normalized([-2 * key[0], -0.5 * key[1], 0.5 * key[2]]),
  };
}

export function uniformsOf(facts: SurfaceFacts, view: View, lighting: Lighting, exaggeration: number): Uniforms {
  const { origin, step } = facts.grid;
  const eye = scaled(sub(view.eye, origin), 1 / step);
  const whole = eye.map((c) => Math.min(2 ** 30 - 1, Math.max(1 - 2 ** 30, Math.floor(c)))) as Vec3;
  const uniforms: Uniforms = {
    ints: { eye_whole: whole, relief_kind: [facts.relief ? 0 : 1] },
    floats: {
      ...lightUniforms(view, lighting),
      eye_part: sub(eye, whole),
      rotation: frameOf(view).flat(),
      near_units: [nearPlaneUnits],
      exaggeration: [facts.relief ? exaggeration : 1],
    },
  };
  if (facts.relief) addRelief(uniforms, facts.relief, facts.grid, eye);
  return uniforms;
}

function addRelief(u: Uniforms, r: ReliefFacts, grid: SurfaceFacts['grid'], eye: Vec3) {
  const plane = r.equatorialRadius === 0;
  const toEye = sub(eye, scaled(sub(r.origin, grid.origin), 1 / grid.step));
  const radii = [r.equatorialRadius / grid.step, r.equatorialRadius / grid.step, r.polarRadius / grid.step];
  u.ints.relief_kind = [plane ? 1 : 2];
  u.floats.relief_north = r.axes[plane ? 1 : 2];
  if (plane) {
    u.floats.relief_up = r.axes[2];
    u.floats.relief_eye_height = [dot(toEye, r.axes[2])];
  } else {
    const q = r.axes.map((axis, i) => dot(toEye, axis) / radii[i]) as Vec3;
    u.floats.relief_to_radii = r.axes.flatMap((axis, i) => scaled(axis, 1 / radii[i]));
    u.floats.relief_eye = q;
    u.floats.relief_excess = [dot(q, q) - 1];
  }
  addHeights(u, r, grid.step);
}

function addHeights(u: Uniforms, r: ReliefFacts, step: number) {
  const least = r.least - r.seaLevel;
  const most = r.most - r.seaLevel;
  u.ints.vertex_colours = [r.vertexColours ? 1 : 0];
  u.floats.unit = [step];
  u.floats.shore = [Math.max(Math.min(step, most / 2), 0)]; // vertices of a flat sea are on the grid, too
  u.floats.sea_level = [r.seaLevel];
  u.floats.sea_floor = [Math.min(least, 0)];
  u.floats.land_least = [Math.max(least, 0)];
  u.floats.land_most = [Math.max(most, least + 1, 1)];
}
