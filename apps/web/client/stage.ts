// What both renderers draw on: a WebGL 2 context with reversed depth, programs of the native shaders, and a frame target.

import { FrameTarget, linked } from './frame_target.ts';
import type { Shaders, Shading, Vec3, View } from './types.ts';
import { linearOf, type Uniforms } from './uniforms.ts';

export interface Program {
  id: WebGLProgram;
  at: Map<string, WebGLUniformLocation | null>;
}

interface ClipControl {
  LOWER_LEFT_EXT: number;
  ZERO_TO_ONE_EXT: number;
  clipControlEXT(origin: number, depth: number): void;
}

const negativeOneToOne = 0x935e; // of EXT_clip_control: what others expect

export class Stage {
  readonly gl: WebGL2RenderingContext;
  private readonly clipControl: ClipControl | null;
  private readonly shaders: Shaders;
  private readonly programs = new Map<Shading, Program>();
  private readonly target: FrameTarget;

  /** @throws where there is no WebGL 2. */
  constructor(canvas: HTMLCanvasElement | OffscreenCanvas, shaders: { clipControl: Shaders; fragmentDepth: Shaders }) {
    const attributes = { antialias: false, depth: false, alpha: false, powerPreference: 'high-performance' };
    const gl = canvas.getContext('webgl2', attributes) as WebGL2RenderingContext | null;
    if (!gl) throw new Error('This browser has no WebGL 2, or it is switched off.');
    this.gl = gl;
    this.clipControl = gl.getExtension('EXT_clip_control') as ClipControl | null;
    this.shaders = this.clipControl ? shaders.clipControl : shaders.fragmentDepth;
    this.target = new FrameTarget(gl);
  }

  /** An empty picture of the view's size. */
  begin(view: View, background: Vec3) {
    const { gl, clipControl } = this;
    this.target.begin(view.width, view.height);
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

  /** Onto the canvas. */
  end() {
    this.clipControl?.clipControlEXT(this.clipControl.LOWER_LEFT_EXT, negativeOneToOne);
    this.target.end();
  }

  /** @throws where the driver refuses a shader. */
  use(shading: Shading, uniforms: Uniforms): Program {
    let program = this.programs.get(shading);
    if (!program) {
      program = { id: linked(this.gl, ...this.shaders[shading]), at: new Map() };
      this.programs.set(shading, program);
    }
    this.gl.useProgram(program.id);
    this.set(program, uniforms);
    return program;
  }

  set(program: Program, { ints, floats }: Uniforms) {
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

  location(program: Program, name: string) {
    if (!program.at.has(name)) program.at.set(name, this.gl.getUniformLocation(program.id, name));
    return program.at.get(name)!;
  }

  delete() {
    this.target.delete();
    for (const { id } of this.programs.values()) this.gl.deleteProgram(id);
  }
}

/** Attributes 0, 1 and 2 of the bound array: vertices as of Change in the bound buffer. */
export function describeVertices(gl: WebGL2RenderingContext, bytes: number) {
  for (const i of [0, 1, 2]) gl.enableVertexAttribArray(i);
  gl.vertexAttribIPointer(0, 3, gl.INT, bytes, 0);
  gl.vertexAttribIPointer(1, 2, gl.SHORT, bytes, 12);
  gl.vertexAttribPointer(2, 4, gl.UNSIGNED_BYTE, true, bytes, 16);
}
