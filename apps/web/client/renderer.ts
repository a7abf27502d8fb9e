// Draws a surface with WebGL 2, as the native renderer draws it: with its shaders, on a page's or a worker's canvas.

import { FrameTarget, linked } from './frame_target.ts';
import { GlPool } from './gl_pool.ts';
import { type Change, type Shaders, type Shading, type SurfaceFacts, type View, type Vec3, wordsOfVertex } from './types.ts';
import { type Lighting, linearOf, type Uniforms, uniformsOf, usualLighting } from './uniforms.ts';

export interface DrawOptions {
  /** `levels`: a colour for each round of the pages, by how coarse they are. Default: relief for terrain, else lit. */
  shading?: Shading | 'levels';
  background?: Vec3; // sRGB bytes
  lighting?: Lighting;
  exaggeration?: number;
}

interface Program {
  id: WebGLProgram;
  at: Map<string, WebGLUniformLocation | null>;
}

interface ClipControl {
  LOWER_LEFT_EXT: number;
  ZERO_TO_ONE_EXT: number;
  clipControlEXT(origin: number, depth: number): void;
}

interface MultiDraw {
  multiDrawElementsWEBGL(
    mode: number,
    counts: Int32Array,
    countsAt: number,
    type: number,
    offsets: Int32Array,
    offsetsAt: number,
    draws: number,
  ): void;
}

export class SurfaceRenderer {
  readonly gl: WebGL2RenderingContext;
  private readonly clipControl: ClipControl | null;
  private readonly multiDraw: MultiDraw | null;
  private readonly shaders: Shaders;
  private readonly programs = new Map<Shading, Program>();
  private readonly target: FrameTarget;
  private readonly vertices: GlPool;
  private readonly indices: GlPool;
  private readonly array: WebGLVertexArrayObject;
  private counts = new Int32Array();
  private offsets = new Int32Array();
  private pages = new Uint32Array();

  /** @throws where there is no WebGL 2, or the driver refuses a shader. */
  constructor(
    readonly canvas: HTMLCanvasElement | OffscreenCanvas,
    private readonly surface: { facts: SurfaceFacts; shaders: { clipControl: Shaders; fragmentDepth: Shaders } },
  ) {
    const attributes = { antialias: false, depth: false, alpha: false, powerPreference: 'high-performance' };
    const gl = canvas.getContext('webgl2', attributes) as WebGL2RenderingContext | null;
    if (!gl) throw new Error('This browser has no WebGL 2, or it is switched off.');
    this.gl = gl;
    this.clipControl = gl.getExtension('EXT_clip_control') as ClipControl | null;
    this.multiDraw = gl.getExtension('WEBGL_multi_draw') as MultiDraw | null;
    this.shaders = this.clipControl ? surface.shaders.clipControl : surface.shaders.fragmentDepth;
    this.target = new FrameTarget(gl);
    this.vertices = new GlPool(gl, gl.ARRAY_BUFFER, wordsOfVertex);
    this.indices = new GlPool(gl, gl.ELEMENT_ARRAY_BUFFER, 1);
    this.array = gl.createVertexArray();
  }

  /** Bytes of the GPU's copies of the pools. */
  get bytes() {
    return this.vertices.bytes + this.indices.bytes;
  }

  apply(change: Change) {
    const { gl } = this;
    gl.bindVertexArray(this.array);
    if (this.vertices.apply(change.vertexCount, change.vertexRanges, change.vertices)) this.setAttributes();
    this.indices.apply(change.indexCount, change.indexRanges, change.indices);
    gl.bindVertexArray(null);
    const draws = change.draws.length / 2;
    this.counts = new Int32Array(draws);
    this.offsets = new Int32Array(draws);
    for (let i = 0; i < draws; ++i) {
      this.offsets[i] = change.draws[2 * i] * 4;
      this.counts[i] = change.draws[2 * i + 1];
    }
    this.pages = change.drawPages.slice();
  }

  draw(view: View, options: DrawOptions = {}) {
    const { gl } = this;
    const shading = options.shading ?? (this.surface.facts.relief ? 'relief' : 'lit');
    const program = this.program(shading === 'levels' ? 'pages' : shading);
    this.target.begin(view.width, view.height);
    this.setState(options.background ?? [255, 255, 255]);
    gl.useProgram(program.id);
    const lighting = options.lighting ?? usualLighting;
    this.setUniforms(program, uniformsOf(this.surface.facts, view, lighting, options.exaggeration ?? 1));
    gl.bindVertexArray(this.array);
    if (shading === 'pages' || shading === 'levels') this.drawPages(program, shading === 'levels');
    else this.drawAll();
    gl.bindVertexArray(null);
    this.clipControl?.clipControlEXT(this.clipControl.LOWER_LEFT_EXT, 0x935e); // negative one to one, for others
    this.target.end();
  }

  /** Frees what the GPU has. */
  delete() {
    this.vertices.delete();
    this.indices.delete();
    this.target.delete();
    this.gl.deleteVertexArray(this.array);
    for (const { id } of this.programs.values()) this.gl.deleteProgram(id);
  }

  private setAttributes() {
    const { gl } = this;
    const bytes = wordsOfVertex * 4;
    for (const i of [0, 1, 2]) gl.enableVertexAttribArray(i);
    gl.vertexAttribIPointer(0, 3, gl.INT, bytes, 0);
    gl.vertexAttribIPointer(1, 2, gl.SHORT, bytes, 12);
    gl.vertexAttribPointer(2, 4, gl.UNSIGNED_BYTE, true, bytes, 16);
  }

  private setState(background: Vec3) {
    const { gl, clipControl } = this;
    const [r, g, b] = linearOf(background);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.GREATER); // reversed: 1 at the near plane, 0 far away
    gl.depthMask(true);
    clipControl?.clipControlEXT(clipControl.LOWER_LEFT_EXT, clipControl.ZERO_TO_ONE_EXT);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.BLEND);
    gl.clearColor(r, g, b, 1);
    gl.clearDepth(0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  private program(shading: Shading): Program {
    let program = this.programs.get(shading);
    if (!program) {
      program = { id: linked(this.gl, ...this.shaders[shading]), at: new Map() };
      this.programs.set(shading, program);
    }
    return program;
  }

  private location(program: Program, name: string) {
    if (!program.at.has(name)) program.at.set(name, this.gl.getUniformLocation(program.id, name));
    return program.at.get(name)!;
  }

  private setUniforms(program: Program, { ints, floats }: Uniforms) {
    const { gl } = this;
    for (const [name, n] of Object.entries(ints)) {
      if (n.length === 1) gl.uniform1i(this.location(program, name), n[0]);
      else gl.uniform3iv(this.location(program, name), n);
    }
    for (const [name, n] of Object.entries(floats)) {
      const at = this.location(program, name);
      if (n.length === 1) gl.uniform1fv(at, n);
      if (n.length === 2) gl.uniform2fv(at, n);
      if (n.length === 3) gl.uniform3fv(at, n);
      if (n.length === 9) gl.uniformMatrix3fv(at, true, n);
    }
  }

  private drawAll() {
    const { gl, counts, offsets } = this;
    if (counts.length === 0) return;
    if (this.multiDraw)
      this.multiDraw.multiDrawElementsWEBGL(gl.TRIANGLES, counts, 0, gl.UNSIGNED_INT, offsets, 0, counts.length);
    else counts.forEach((count, i) => gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, offsets[i]));
  }

  private drawPages(program: Program, levels: boolean) {
    const { gl } = this;
    const at = this.location(program, 'page');
    this.counts.forEach((count, i) => {
      const page = this.pages[i];
      gl.uniform1i(at, levels ? this.surface.facts.rounds[page] : page);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, this.offsets[i]);
    });
  }
}
