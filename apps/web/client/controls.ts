// A camera moved by pointer, touch and keys: orbit and fly.

import { frameOf, levelled, moved, orbited, panned, rayDirection, shifted, turned, upAt, zoomed } from './camera.ts';
import type { ReliefFacts, Vec3, View } from './types.ts';
import { add, dot, length, scaled, sub } from './vec.ts';

export type ControlMode = 'orbit' | 'fly';

export interface ControlledSurface {
  facts: { box: [Vec3, Vec3]; relief?: ReliefFacts };
  distanceAlong(origin: Vec3, direction: Vec3, exaggeration?: number): Promise<number>;
}

const zoomPerNotch = 0.85;
const keyTurn = 300; // pixels per second that a held arrow key drags
const keyZoom = 0.25; // factor per second of a held + key
const probeEvery = 0.2; // seconds, while flying: how far away is what is ahead?
const leastDistance = 1e-9; // diagonals

interface Pointer {
  x: number;
  y: number;
  sideways: boolean;
}

export class CameraControls {
  mode: ControlMode = 'orbit';
  exaggeration = 1;
  /** Called when an event moved the camera. */
  onMove: () => void = () => {};
  private readonly pointers = new Map<number, Pointer>();
  private readonly held = new Set<string>();
  private anchor: { x: number; y: number; point: Vec3 } | null = null;
  private readonly diagonal: number;
  private reach: number; // fly: distance of what is ahead
  private sinceProbe = Infinity;
  private speedFactor = 1;
  private readonly ended = new AbortController();

  constructor(
    private readonly element: HTMLElement,
    private readonly surface: ControlledSurface,
    public view: View,
  ) {
    this.diagonal = length(sub(surface.facts.box[1], surface.facts.box[0])) || 1;
    this.reach = this.diagonal;
    const listen = <K extends keyof HTMLElementEventMap>(kind: K, use: (event: HTMLElementEventMap[K]) => void) =>
      element.addEventListener(kind, use, { signal: this.ended.signal, passive: false });
    listen('pointerdown', (e) => this.press(e));
    listen('pointermove', (e) => this.drag(e));
    listen('pointerup', (e) => this.release(e));
    listen('pointercancel', (e) => this.release(e));
    listen('wheel', (e) => this.scroll(e));
    listen('dblclick', (e) => void this.centre(e));
    listen('contextmenu', (e) => e.preventDefault());
    listen('keydown', (e) => this.hold(e));
    listen('keyup', (e) => this.held.delete(e.code));
    listen('blur', () => this.held.clear());
  }

  delete() {
    this.ended.abort();
  }

  setMode(mode: ControlMode) {
    this.mode = mode;
    this.sinceProbe = Infinity;
  }

  /** True while held keys move the camera. */
  get moving() {
    return this.held.size > 0;
  }

  /** Held keys move the camera for `seconds`. */
  advance(seconds: number) {
    this.sinceProbe += seconds;
    if (!this.moving) return;
    if (this.mode === 'fly') this.fly(seconds);
    else this.orbitByKeys(seconds);
    this.onMove();
  }

  private fly(seconds: number) {
    const speed = this.speedFactor * this.reach * (this.fast ? 3 : 0.75) * seconds;
    const right = this.axis(['KeyD', 'ArrowRight'], ['KeyA', 'ArrowLeft']);
    const up = this.axis(['KeyE', 'PageUp'], ['KeyQ', 'PageDown']);
    const forward = this.axis(['KeyW', 'ArrowUp'], ['KeyS', 'ArrowDown']);
    this.view = moved(this.view, right * speed, up * speed, forward * speed);
    const { relief } = this.surface.facts;
    if (relief && relief.equatorialRadius > 0) this.view = levelled(this.view, upAt(relief, this.view.eye));
    if (this.sinceProbe > probeEvery) void this.probe();
  }

  /** Flying is as fast as what is ahead is far, or below where nothing is ahead. */
  private async probe() {
    this.sinceProbe = 0;
    const [, up, back] = frameOf(this.view);
    const eye = this.view.eye;
    const distances = await Promise.all(
      [scaled(back, -1), scaled(up, -1)].map((d) => this.surface.distanceAlong(eye, d, this.exaggeration)),
    );
    const nearest = Math.min(...distances);
    this.reach = Math.min(this.diagonal, Math.max(1e-5 * this.diagonal, isFinite(nearest) ? nearest : this.diagonal / 4));
  }

  private orbitByKeys(seconds: number) {
    const dx = this.axis(['ArrowLeft', 'KeyA'], ['ArrowRight', 'KeyD']) * keyTurn * seconds;
    const dy = this.axis(['ArrowUp', 'KeyW'], ['ArrowDown', 'KeyS']) * keyTurn * seconds;
    const nearer = this.axis(['Equal', 'NumpadAdd', 'PageUp', 'KeyE'], ['Minus', 'NumpadSubtract', 'PageDown', 'KeyQ']);
    this.view = this.fast ? panned(this.view, dx, dy) : orbited(this.view, dx, dy);
    if (nearer !== 0) this.zoom(keyZoom ** (nearer * seconds), this.view.target);
  }

  private get fast() {
    return this.held.has('ShiftLeft') || this.held.has('ShiftRight');
  }

  private axis(plus: string[], minus: string[]) {
    return Number(plus.some((k) => this.held.has(k))) - Number(minus.some((k) => this.held.has(k)));
  }

  private hold(event: KeyboardEvent) {
    const used = /^(Arrow|Key[WASDQE]$|Page|Equal$|Minus$|Numpad(Add|Subtract)$|Shift)/.test(event.code);
    if (!used || event.ctrlKey || event.altKey || event.metaKey) return;
    this.held.add(event.code);
    if (!event.code.startsWith('Shift')) event.preventDefault();
  }

  /** Of an event, in the view's pixels. */
  private at(event: MouseEvent) {
    const box = this.element.getBoundingClientRect();
    const scale = this.view.width / box.width;
    return { x: (event.clientX - box.left) * scale, y: (event.clientY - box.top) * scale };
  }

  private press(event: PointerEvent) {
    this.element.focus({ preventScroll: true });
    this.element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { ...this.at(event), sideways: event.button !== 0 || event.shiftKey });
    if (this.pointers.size === 2) this.seekAnchor(...this.middle());
  }

  private release(event: PointerEvent) {
    this.pointers.delete(event.pointerId);
  }

  private drag(event: PointerEvent) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const before = this.pinch();
    const { x, y } = this.at(event);
    const [dx, dy] = [x - pointer.x, y - pointer.y];
    [pointer.x, pointer.y] = [x, y];
    if (this.pointers.size === 1) {
      if (this.mode === 'fly') this.view = turned(this.view, dx, dy);
      else this.view = pointer.sideways ? panned(this.view, dx, dy) : orbited(this.view, dx, dy);
    } else if (this.pointers.size === 2) {
      this.view = panned(this.view, dx / 2, dy / 2);
      if (before > 0 && this.pinch() > 0) this.zoom(before / this.pinch(), this.anchor?.point ?? this.view.target);
    }
    this.onMove();
  }

  /** Between two fingers. */
  private pinch() {
    if (this.pointers.size !== 2) return 0;
    const [a, b] = [...this.pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  }

  private middle(): [number, number] {
    const [a, b] = [...this.pointers.values()];
    return [(a.x + b.x) / 2, (a.y + b.y) / 2];
  }

  private scroll(event: WheelEvent) {
    event.preventDefault();
    const notches = -event.deltaY / (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 3 : 100);
    if (this.mode === 'fly') {
      this.speedFactor = Math.min(20, Math.max(0.05, this.speedFactor * 1.25 ** notches));
      return;
    }
    const { x, y } = this.at(event);
    if (!this.anchor || Math.hypot(x - this.anchor.x, y - this.anchor.y) > 8) this.seekAnchor(x, y);
    this.zoom(zoomPerNotch ** notches, this.anchor!.point);
    this.onMove();
  }

  private zoom(factor: number, point: Vec3) {
    this.view = zoomed(this.view, factor, point, leastDistance * this.diagonal);
  }

  /** What is at a pixel: at the target's distance until the surface is known there. */
  private seekAnchor(x: number, y: number) {
    const { view } = this;
    const [, , back] = frameOf(view);
    const direction = rayDirection(view, x, y);
    const depth = length(sub(view.eye, view.target)) / -dot(direction, back);
    const anchor = { x, y, point: add(view.eye, scaled(direction, depth)) };
    this.anchor = anchor;
    void this.pick(x, y).then((point) => {
      if (!point || this.anchor !== anchor) return;
      anchor.point = point;
      this.bringTarget(point);
    });
  }

  /** The target comes to the depth of what is looked at: nearer or farther it would be of no use. */
  private bringTarget(point: Vec3) {
    const { eye } = this.view;
    const [, , back] = frameOf(this.view);
    const depth = -dot(sub(point, eye), back);
    if (depth > leastDistance * this.diagonal) this.view = { ...this.view, target: add(eye, scaled(back, -depth)) };
  }

  private async pick(x: number, y: number): Promise<Vec3 | null> {
    const { eye } = this.view;
    const direction = rayDirection(this.view, x, y);
    const distance = await this.surface.distanceAlong(eye, direction, this.exaggeration);
    return isFinite(distance) ? add(eye, scaled(direction, distance)) : null;
  }

  /** What is at the pointer becomes the middle. */
  private async centre(event: MouseEvent) {
    const { x, y } = this.at(event);
    const point = await this.pick(x, y);
    if (!point || this.mode !== 'orbit') return;
    this.view = shifted(this.view, sub(point, this.view.target));
    this.onMove();
  }
}
