// A surface on a canvas: steps towards the view, and draws when something changed.

import {
  type Aim,
  CameraControls,
  CuestaSurface,
  type DrawOptions,
  type Report,
  SceneRenderer,
  type Source,
  SurfaceRenderer,
  type Traffic,
  usualAim,
  type View,
} from '../client/index.ts';

const mostPixelRatio = 2; // beyond it nobody sees a difference, and phones get hot

export class Viewer {
  aim: Aim = { ...usualAim };
  options: DrawOptions = {};
  report: Report | null = null;
  traffic: Traffic | null = null;
  /** Bytes of the file that the first picture needed, and milliseconds from opening to when it was drawn. */
  firstBytes: number | null = null;
  firstMs: number | null = null;
  onStep: () => void = () => {};
  onMove: () => void = () => {};
  readonly renderer: SurfaceRenderer | SceneRenderer;
  readonly controls: CameraControls;
  private dirty = true;
  private time = performance.now();
  private closed = false;

  private constructor(
    readonly canvas: HTMLCanvasElement,
    readonly surface: CuestaSurface,
    view: View,
    private readonly opened: number,
  ) {
    this.renderer = this.drawnBy(surface);
    this.controls = new CameraControls(canvas, surface, view);
    this.controls.onMove = () => this.moved();
    requestAnimationFrame((now) => this.frame(now));
  }

  /** @param view  to begin with; without one all is shown. */
  static async open(canvas: HTMLCanvasElement, source: Source, cacheBytes: number, view?: View) {
    const opened = performance.now();
    const surface = await CuestaSurface.open(source, { cacheBytes });
    const viewer = new Viewer(canvas, surface, view ?? (await surface.firstView(blank(canvas))), opened);
    if (view) viewer.controls.view = { ...view, ...sizeOf(canvas) };
    return viewer;
  }

  get view() {
    return this.controls.view;
  }

  set view(view: View) {
    this.controls.view = view;
    this.moved();
  }

  get settled() {
    return this.surface.settled && !this.dirty;
  }

  async fit() {
    this.view = await this.surface.firstView({ ...blank(this.canvas), fovY: this.view.fovY }, this.aim.exaggeration);
  }

  /** Something of the aim or the options is another now. */
  changed() {
    this.controls.exaggeration = this.aim.exaggeration;
    this.dirty = true;
  }

  /** What is drawn, as the canvas has it: rows from the bottom, RGBA. */
  pixels(): Uint8Array {
    const { gl } = this.renderer;
    this.draw();
    const pixels = new Uint8Array(4 * this.canvas.width * this.canvas.height);
    gl.readPixels(0, 0, this.canvas.width, this.canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  }

  picture(): Promise<Blob | null> {
    this.draw();
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'));
  }

  close() {
    this.closed = true;
    this.surface.close();
    this.controls.delete();
    this.renderer.delete();
  }

  private drawnBy(surface: CuestaSurface): SurfaceRenderer | SceneRenderer {
    if (surface.facts.scene) {
      const renderer = new SceneRenderer(this.canvas, surface);
      surface.onSceneChange = (change, report, traffic) => this.took(() => renderer.apply(change), report, traffic);
      return renderer;
    }
    const renderer = new SurfaceRenderer(this.canvas, surface);
    surface.onChange = (change, report, traffic) => this.took(() => renderer.apply(change), report, traffic);
    return renderer;
  }

  private took(apply: () => void, report: Report, traffic: Traffic) {
    apply();
    [this.report, this.traffic, this.dirty] = [report, traffic, true];
    if (report.triangles > 0) this.firstBytes ??= traffic.bytes;
    this.onStep();
  }

  private moved() {
    this.dirty = true;
    this.onMove();
  }

  private frame(now: number) {
    if (this.closed) return;
    this.controls.advance(Math.min(0.1, (now - this.time) / 1000));
    this.time = now;
    const { width, height } = sizeOf(this.canvas);
    if (width !== this.canvas.width || height !== this.canvas.height) {
      [this.canvas.width, this.canvas.height] = [width, height];
      this.dirty = true;
    }
    this.controls.view = { ...this.view, width, height };
    this.surface.look(this.view, this.aim);
    if (this.dirty) this.draw();
    requestAnimationFrame((next) => this.frame(next));
  }

  private draw() {
    this.dirty = false;
    this.renderer.draw(this.view, { ...this.options, exaggeration: this.aim.exaggeration });
    if (this.report?.triangles) this.firstMs ??= performance.now() - this.opened;
  }
}

function sizeOf(canvas: HTMLCanvasElement) {
  const ratio = Math.min(mostPixelRatio, devicePixelRatio);
  return {
    width: Math.max(1, Math.round(canvas.clientWidth * ratio)),
    height: Math.max(1, Math.round(canvas.clientHeight * ratio)),
  };
}

function blank(canvas: HTMLCanvasElement): View {
  return { eye: [0, 0, 1], target: [0, 0, 0], up: [0, 1, 0], fovY: Math.PI / 3, ...sizeOf(canvas) };
}
