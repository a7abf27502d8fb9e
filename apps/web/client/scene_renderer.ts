// Draws a scene with WebGL 2, as the native renderer draws it: one call for each group of instances.

import { frameOf } from './camera.ts';
import type { DrawOptions } from './renderer.ts';
import { describeVertices, type Program, Stage } from './stage.ts';
import { type SceneChange, type SceneGroup, type Shaders, type SurfaceFacts, type Vec3, type View, wordsOfVertex } from './types.ts';
import { linearOf, lightUniforms, type Uniforms, usualLighting } from './uniforms.ts';
import { dot, length, sub } from './vec.ts';
import { edgesOf, indicesOf, lineUniforms } from './wireframe.ts';

const rowFloats = 16; // of an instance: three rows of its map into the camera's frame, and its colour
const firstRow = 3; // attribute
const tint = 6; // attribute
const nearestShare = 1e-6; // of the scene's diagonal: what is nearer is not drawn
const materialsHaveColours: Vec3 = [255, 255, 255];

interface Part {
  array: WebGLVertexArrayObject;
  buffer: WebGLBuffer;
  bytes: number;
}

interface Block {
  triangles: WebGLBuffer;
  edges: WebGLBuffer | null;
  count: number; // indices of triangles
}

export class SceneRenderer {
  private readonly stage: Stage;
  private readonly parts = new Map<number, Part>();
  private readonly blocks = new Map<number, Block>();
  private readonly instances: WebGLBuffer;
  private groups: SceneGroup[] = [];
  private maps: Float64Array = new Float64Array();
  private rows = new Float32Array();
  private readonly nearest: number;

  /** @throws where there is no WebGL 2, or the driver refuses a shader. */
  constructor(
    readonly canvas: HTMLCanvasElement | OffscreenCanvas,
    scene: { facts: SurfaceFacts; shaders: { clipControl: Shaders; fragmentDepth: Shaders } },
  ) {
    this.stage = new Stage(canvas, scene.shaders);
    this.instances = this.gl.createBuffer();
    this.nearest = nearestShare * length(sub(scene.facts.box[1], scene.facts.box[0])) || nearestShare;
  }

  get gl() {
    return this.stage.gl;
  }

  /** Bytes of the GPU's copies of parts and blocks. */
  get bytes() {
    let sum = this.rows.byteLength;
    for (const { bytes } of this.parts.values()) sum += bytes;
    for (const { count, edges } of this.blocks.values()) sum += 4 * count * (edges ? 3 : 1);
    return sum;
  }

  apply(change: SceneChange) {
    for (const { part, vertices } of change.parts) this.takePart(part, vertices);
    for (const { block, triangles } of change.blocks) this.takeBlock(block, triangles);
    change.forgottenParts.forEach((part) => this.forgetPart(part));
    change.forgottenBlocks.forEach((block) => this.forgetBlock(block));
    this.groups = change.groups;
    this.maps = change.maps;
    this.rows = new Float32Array((change.maps.length / 12) * rowFloats);
    for (let i = 0; i < this.rows.length / rowFloats; ++i) {
      const [r, g, b] = change.colours.subarray(4 * i, 4 * i + 3);
      this.rows.set([...linearOf([r, g, b]), 1], i * rowFloats + 12);
    }
  }

  draw(view: View, options: DrawOptions = {}) {
    const { gl, stage } = this;
    const lighting = options.lighting ?? { ...usualLighting, surfaceColour: materialsHaveColours };
    const uniforms: Uniforms = {
      ints: { anchor: [0, 0, 0] },
      floats: { ...lightUniforms(view, lighting), near_units: [this.nearest] },
    };
    stage.begin(view, options.background ?? [255, 255, 255]);
    const program = stage.use(options.shading === 'normals' ? 'normals' : 'lit', uniforms);
    this.placeInstances(view);
    for (const group of this.groups) this.drawGroup(group, false);
    if (options.shading === 'wireframe') this.drawEdges(program, uniforms);
    gl.bindVertexArray(null);
    stage.end();
  }

  /** Frees what the GPU has. */
  delete() {
    for (const part of [...this.parts.keys()]) this.forgetPart(part);
    for (const block of [...this.blocks.keys()]) this.forgetBlock(block);
    this.gl.deleteBuffer(this.instances);
    this.stage.delete();
  }

  private takePart(id: number, vertices: Uint32Array) {
    const { gl } = this;
    const part = this.parts.get(id) ?? { array: gl.createVertexArray(), buffer: gl.createBuffer(), bytes: 0 };
    this.parts.set(id, part);
    part.bytes = vertices.byteLength;
    gl.bindVertexArray(part.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, part.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
    describeVertices(gl, wordsOfVertex * 4);
    for (let a = firstRow; a <= tint; ++a) {
      gl.enableVertexAttribArray(a);
      gl.vertexAttribDivisor(a, 1);
    }
    gl.bindVertexArray(null);
  }

  private takeBlock(id: number, triangles: Uint32Array) {
    const { gl } = this;
    gl.bindVertexArray(null); // whose index buffer this is not
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    this.blocks.set(id, { triangles: buffer, edges: null, count: triangles.length });
  }

  private forgetPart(id: number) {
    const part = this.parts.get(id);
    this.gl.deleteVertexArray(part?.array ?? null);
    this.gl.deleteBuffer(part?.buffer ?? null);
    this.parts.delete(id);
  }

  private forgetBlock(id: number) {
    const block = this.blocks.get(id);
    this.gl.deleteBuffer(block?.triangles ?? null);
    this.gl.deleteBuffer(block?.edges ?? null);
    this.blocks.delete(id);
  }

  /** Maps into the camera's frame, in f64 as far as they are large. */
  private placeInstances(view: View) {
    const { gl, maps, rows } = this;
    const frame = frameOf(view);
    for (const { origin, step, first, count } of this.groups)
      for (let i = first; i < first + count; ++i) {
        const column = (k: number): Vec3 => [maps[12 * i + 3 * k], maps[12 * i + 3 * k + 1], maps[12 * i + 3 * k + 2]];
        const [x, y, z, moved] = [column(0), column(1), column(2), column(3)];
        const fromEye = moved.map(
          (m, a) => m + x[a] * origin[0] + y[a] * origin[1] + z[a] * origin[2] - view.eye[a],
        ) as Vec3;
        frame.forEach((axis, r) => {
          const at = i * rowFloats + 4 * r;
          rows[at] = dot(axis, x) * step;
          rows[at + 1] = dot(axis, y) * step;
          rows[at + 2] = dot(axis, z) * step;
          rows[at + 3] = dot(axis, fromEye);
        });
      }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, rows, gl.STREAM_DRAW);
  }

  private drawGroup(group: SceneGroup, edges: boolean) {
    const { gl } = this;
    const [part, block] = [this.parts.get(group.part), this.blocks.get(group.block)];
    if (!part || !block || block.count === 0) return;
    gl.bindVertexArray(part.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    for (let a = firstRow; a <= tint; ++a)
      gl.vertexAttribPointer(a, 4, gl.FLOAT, false, 4 * rowFloats, 4 * (group.first * rowFloats + 4 * (a - firstRow)));
    gl.frontFace(group.mirrored ? gl.CW : gl.CCW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, edges ? this.edgesOf(block) : block.triangles);
    const count = edges ? 2 * block.count : block.count;
    gl.drawElementsInstanced(edges ? gl.LINES : gl.TRIANGLES, count, gl.UNSIGNED_INT, 0, group.count);
    gl.frontFace(gl.CCW);
  }

  private edgesOf(block: Block): WebGLBuffer {
    const { gl } = this;
    if (block.edges) return block.edges;
    const edges = edgesOf(indicesOf(gl, block.triangles, 0, block.count));
    block.edges = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, block.edges);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, edges, gl.STATIC_DRAW);
    return block.edges;
  }

  private drawEdges(program: Program, uniforms: Uniforms) {
    this.stage.set(program, lineUniforms(uniforms));
    for (const group of this.groups) this.drawGroup(group, true);
  }
}
