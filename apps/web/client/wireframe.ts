// Edges over a shaded picture. There are no geometry shaders in WebGL, so edges are lines of their own, made of the
// triangles on the GPU when they are asked for: a debug view, whose cost is three lines a triangle.

import type { Uniforms } from './uniforms.ts';

const lineColour = [0.022, 0.032, 0.05]; // linear, as the native renderer's
const nearer = 1.001; // than the triangles whose edges they are: depth is the near distance over the own one

/** What lines are drawn with after triangles were. */
export function lineUniforms(of: Uniforms): Uniforms {
  return { ints: {}, floats: { surface_colour: lineColour, near_units: [of.floats.near_units[0] * nearer] } };
}

/** Two indices an edge, three edges a triangle. */
export function edgesOf(triangles: Uint32Array): Uint32Array {
  const edges = new Uint32Array(2 * triangles.length);
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [triangles[i], triangles[i + 1], triangles[i + 2]];
    edges.set([a, b, b, c, c, a], 2 * i);
  }
  return edges;
}

/** Elements of an index buffer: waits for the GPU. */
export function indicesOf(gl: WebGL2RenderingContext, buffer: WebGLBuffer, first: number, count: number): Uint32Array {
  const indices = new Uint32Array(count);
  gl.bindBuffer(gl.COPY_READ_BUFFER, buffer);
  gl.getBufferSubData(gl.COPY_READ_BUFFER, 4 * first, indices);
  gl.bindBuffer(gl.COPY_READ_BUFFER, null);
  return indices;
}
