// The GPU copy of a pool that changes a little in each step and sometimes grows.

import { eachRange } from './types.ts';

export class GlPool {
  buffer: WebGLBuffer;
  private capacity = 0; // words

  constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly target: GLenum,
    private readonly wordsOfElement: number,
  ) {
    this.buffer = gl.createBuffer();
  }

  get bytes() {
    return this.capacity * 4;
  }

  /** @returns true if the buffer is another one: what refers to it must be set again. */
  apply(elements: number, ranges: Uint32Array, words: Uint32Array): boolean {
    const { gl, wordsOfElement } = this;
    const moved = elements * wordsOfElement > this.capacity;
    if (moved) this.grow(elements * wordsOfElement);
    gl.bindBuffer(this.target, this.buffer);
    eachRange(ranges, (first, count, at) => {
      if (count > 0)
        gl.bufferSubData(this.target, first * wordsOfElement * 4, words, at * wordsOfElement, count * wordsOfElement);
    });
    return moved;
  }

  delete() {
    this.gl.deleteBuffer(this.buffer);
  }

  private grow(words: number) {
    const { gl } = this;
    const larger = gl.createBuffer();
    const capacity = Math.max(words, Math.ceil(this.capacity * 1.5));
    // An index buffer of WebGL may be bound as nothing else, but to be copied from and to.
    gl.bindBuffer(this.target, larger);
    gl.bufferData(this.target, capacity * 4, gl.DYNAMIC_DRAW);
    if (this.capacity > 0) {
      gl.bindBuffer(gl.COPY_READ_BUFFER, this.buffer);
      gl.copyBufferSubData(gl.COPY_READ_BUFFER, this.target, 0, 0, this.capacity * 4);
      gl.bindBuffer(gl.COPY_READ_BUFFER, null);
    }
    gl.deleteBuffer(this.buffer);
    this.buffer = larger;
    this.capacity = capacity;
  }
}
