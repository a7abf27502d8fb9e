// Cameras moved a little, as the native viewer moves them. Pixels are the view's; `up` of the view stays.

import type { ReliefFacts, Vec3, View } from './types.ts';
import { add, cross, dot, length, normalized, rotated, scaled, sub } from './vec.ts';

const leastAngle = Math.PI / 180; // between the line of sight and up

/** Orthonormal: right, up, back (the camera looks along -back). */
export function frameOf(view: View): [Vec3, Vec3, Vec3] {
  const back = normalized(sub(view.eye, view.target));
  let right = cross(view.up, back);
  if (dot(right, right) < 1e-24) right = cross([back[1], back[2], back[0]], back);
  right = normalized(right);
  return [right, cross(back, right), back];
}

/** Pixels that a unit of length covers at distance one. */
export function pixelsPerUnit(view: View) {
  return view.height / (2 * Math.tan(view.fovY / 2));
}

/** `v` turned about up by `yaw`, then towards up by `pitch`, as far as the poles allow. */
function turnedDirection(v: Vec3, up: Vec3, yaw: number, pitch: number): Vec3 {
  const size = length(v);
  const elevation = Math.acos(Math.min(1, Math.max(-1, dot(v, up) / size))); // from up
  const wanted = Math.min(Math.PI - leastAngle, Math.max(leastAngle, elevation - pitch));
  let level = sub(v, scaled(up, dot(v, up)));
  if (length(level) < 1e-12 * size) level = cross(up, Math.abs(up[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0]);
  level = rotated(normalized(level), up, yaw);
  return scaled(add(scaled(up, Math.cos(wanted)), scaled(level, Math.sin(wanted))), size);
}

/** Around the target; half a turn takes the picture's height. */
export function orbited(view: View, dx: number, dy: number): View {
  const perPixel = Math.PI / view.height;
  const up = normalized(view.up);
  const arm = turnedDirection(sub(view.eye, view.target), up, -dx * perPixel, dy * perPixel);
  return { ...view, eye: add(view.target, arm) };
}

export function shifted(view: View, by: Vec3): View {
  return { ...view, eye: add(view.eye, by), target: add(view.target, by) };
}

/** Sideways: what is at the target's distance follows the pointer. */
export function panned(view: View, dx: number, dy: number): View {
  const [right, up] = frameOf(view);
  const perPixel = length(sub(view.eye, view.target)) / pixelsPerUnit(view);
  return shifted(view, add(scaled(right, -dx * perPixel), scaled(up, dy * perPixel)));
}

/** So many times nearer to a point, which stays where it is in the picture. */
export function zoomed(view: View, factor: number, point: Vec3, leastDistance: number): View {
  const distance = length(sub(view.eye, view.target));
  const f = factor < 1 ? Math.min(1, Math.max(factor, leastDistance / distance)) : factor;
  const move = (p: Vec3) => add(point, scaled(sub(p, point), f));
  return { ...view, eye: move(view.eye), target: move(view.target) };
}

/** Turned about the eye, to the right and down with the pointer. */
export function turned(view: View, dx: number, dy: number): View {
  const perPixel = (1.6 * view.fovY) / view.height;
  const ahead = turnedDirection(sub(view.target, view.eye), normalized(view.up), -dx * perPixel, -dy * perPixel);
  return { ...view, target: add(view.eye, ahead) };
}

/** By lengths along the camera's right, the world's up, and where the camera looks. */
export function moved(view: View, right: number, up: number, forward: number): View {
  const [r, , back] = frameOf(view);
  return shifted(view, add(add(scaled(r, right), scaled(normalized(view.up), up)), scaled(back, -forward)));
}

/** Where a pixel looks; unit. */
export function rayDirection(view: View, x: number, y: number): Vec3 {
  const [right, up, back] = frameOf(view);
  const perPixel = 1 / pixelsPerUnit(view);
  const across = scaled(right, (x - view.width / 2) * perPixel);
  const above = scaled(up, -(y - view.height / 2) * perPixel);
  return normalized(sub(add(across, above), back));
}

/** Up at a point of a terrain. */
export function upAt(relief: ReliefFacts, p: Vec3): Vec3 {
  if (relief.equatorialRadius === 0) return relief.axes[2];
  const radii = [relief.equatorialRadius, relief.equatorialRadius, relief.polarRadius];
  let gradient: Vec3 = [0, 0, 0];
  relief.axes.forEach((axis, i) => {
    gradient = add(gradient, scaled(axis, dot(sub(p, relief.origin), axis) / radii[i] ** 2));
  });
  return length(gradient) > 0 ? normalized(gradient) : relief.axes[2];
}

/** `view` with another up; it looks as far above the horizon, and as far to the side, as before. */
export function levelled(view: View, up: Vec3): View {
  const was = normalized(view.up);
  const axis = cross(was, up);
  const sine = length(axis);
  if (sine < 1e-15) return { ...view, up };
  const ahead = rotated(sub(view.target, view.eye), scaled(axis, 1 / sine), Math.atan2(sine, dot(was, up)));
  return { ...view, up, target: add(view.eye, turnedDirection(ahead, up, 0, 0)) };
}
