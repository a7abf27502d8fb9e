// Draws a surface with WebGL 2, as the native renderer draws it: with its shaders, on a page's or a worker's canvas.

import { GlPool } from './gl_pool.ts';
import { describeVertices, type Program, Stage } from './stage.ts';
import { type Change, type Shaders, type Shading, type SurfaceFacts, type View, type Vec3, wordsOfVertex } from './types.ts';
import { type Lighting, type Uniforms, uniformsOf, usualLighting } from './uniforms.ts';
import { edgesOf, indicesOf, lineUniforms } from './wireframe.ts';

export interface DrawOptions {
  /** `levels`: a colour for each round of the pages, by how coarse they are. `wireframe`: lit, with edges. Scenes have lit,
   *  normals and wireframe. Default: relief for terrain, else lit. */
  shading?: Shading | 'levels' | 'wireframe';
  background?: Vec3; // sRGB bytes
  lighting?: Lighting;
  exaggeration?: number;
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
  private readonly stage: Stage;
  private readonly multiDraw: MultiDraw | null;
  private readonly vertices: GlPool;
  private readonly indices: GlPool;
  private readonly array: WebGLVertexArrayObject;
  private counts = new Int32Array();
  private offsets = new Int32Array();
  private pages = new Uint32Array();
  private readonly lineArray: WebGLVertexArrayObject;
  private readonly lineBuffer: WebGLBuffer;
  private lineCount: number | null = null; // null: of triangles that are no more

  /** @throws where there is no WebGL 2, or the driver refuses a shader. */
  constructor(
    readonly canvas: HTMLCanvasElement | OffscreenCanvas,
    private readonly surface: { facts: SurfaceFacts; shaders: { clipControl: Shaders; fragmentDepth: Shaders } },
  ) {
    this.stage = new Stage(canvas, surface.shaders);
    const { gl } = this;
    this.multiDraw = gl.getExtension('WEBGL_multi_draw') as MultiDraw | null;
    this.vertices = new GlPool(gl, gl.ARRAY_BUFFER, wordsOfVertex);
    this.indices = new GlPool(gl, gl.ELEMENT_ARRAY_BUFFER, 1);
    this.array = gl.createVertexArray();
    this.lineArray = gl.createVertexArray();
    this.lineBuffer = gl.createBuffer();
  }

  get gl() {
    return this.stage.gl;
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
    this.lineCount = null;
  }

  draw(view: View, options: DrawOptions = {}) {
    const { gl, stage } = this;
    const shading = options.shading ?? (this.surface.facts.relief ? 'relief' : 'lit');
    const shaders = shading === 'levels' ? 'pages' : shading === 'wireframe' ? 'lit' : shading;
    const uniforms = uniformsOf(this.surface.facts, view, options.lighting ?? usualLighting, options.exaggeration ?? 1);
    stage.begin(view, options.background ?? [255, 255, 255]);
    const program = stage.use(shaders, uniforms);
    gl.bindVertexArray(this.array);
    if (shaders === 'pages') this.drawPages(program, shading === 'levels');
    else this.drawAll();
    if (shading === 'wireframe') this.drawEdges(program, uniforms);
    gl.bindVertexArray(null);
    stage.end();
  }

  /** Frees what the GPU has. */
  delete() {
    this.vertices.delete();
    this.indices.delete();
    this.stage.delete();
    this.gl.deleteVertexArray(this.array);
    this.gl.deleteVertexArray(this.lineArray);
    this.gl.deleteBuffer(this.lineBuffer);
  }

  /** @pre the array and the buffer of vertices are bound */
  private setAttributes() {
    const { gl } = this;
    describeVertices(gl, wordsOfVertex * 4);
    gl.bindVertexArray(this.lineArray);
    describeVertices(gl, wordsOfVertex * 4);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.lineBuffer);
    gl.bindVertexArray(this.array);
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
    const at = this.stage.location(program, 'page');
    this.counts.forEach((count, i) => {
      const page = this.pages[i];
      gl.uniform1i(at, levels ? this.surface.facts.rounds[page] : page);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, this.offsets[i]);
    });
  }

  private drawEdges(program: Program, uniforms: Uniforms) {
    const { gl } = this;
    gl.bindVertexArray(this.lineArray);
    this.lineCount ??= this.makeEdges();
    this.stage.set(program, lineUniforms(uniforms));
    gl.drawElements(gl.LINES, this.lineCount, gl.UNSIGNED_INT, 0);
  }

  /** @returns how many indices. @pre the array of lines is bound */
  private makeEdges(): number {
    const { gl } = this;
    const total = this.counts.reduce((sum, count) => sum + count, 0);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, 8 * total, gl.STREAM_DRAW);
    let at = 0;
    this.counts.forEach((count, i) => {
      const edges = edgesOf(indicesOf(gl, this.indices.buffer, this.offsets[i] / 4, count));
      gl.bufferSubData(gl.ELEMENT_ARRAY_BUFFER, 4 * at, edges);
      at += edges.length;
    });
    return at;
  }
}
