// What is drawn into: linear light kept as sRGB, four samples per pixel, a depth of 32-bit floats, as the native
// renderer's. A canvas keeps bytes as they come, so the picture is encoded on its way there.

const samplesWanted = 4;

const wholeScreen = `#version 300 es
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.5, 1.0);
}`;

const encode = `#version 300 es
precision highp float;
uniform sampler2D picture;  // decoded as it is read
out vec4 pixel;
void main() {
  vec3 c = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
  pixel = vec4(mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308))), 1.0);
}`;

export class FrameTarget {
  private width = 0;
  private height = 0;
  private drawn: WebGLFramebuffer | null = null;
  private resolved: WebGLFramebuffer | null = null;
  private colour: WebGLRenderbuffer | null = null;
  private depth: WebGLRenderbuffer | null = null;
  private picture: WebGLTexture | null = null;
  private readonly program: WebGLProgram;
  private readonly nothing: WebGLVertexArrayObject;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = linked(gl, wholeScreen, encode);
    this.nothing = gl.createVertexArray();
  }

  begin(width: number, height: number) {
    if (width !== this.width || height !== this.height) this.allocate(width, height);
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.drawn);
    this.gl.viewport(0, 0, width, height);
  }

  /** Onto the canvas. */
  end() {
    const { gl, width, height } = this;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.drawn);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.resolved);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
  }

  delete() {
    this.release();
    this.gl.deleteProgram(this.program);
    this.gl.deleteVertexArray(this.nothing);
  }

  private allocate(width: number, height: number) {
    const { gl } = this;
    this.release();
    [this.width, this.height] = [width, height];
    const samples = Math.min(samplesWanted, gl.getParameter(gl.MAX_SAMPLES) as number);
    this.drawn = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.drawn);
    this.colour = this.attach(gl.SRGB8_ALPHA8, gl.COLOR_ATTACHMENT0, samples);
    this.depth = this.attach(gl.DEPTH_COMPONENT32F, gl.DEPTH_ATTACHMENT, samples);
    this.resolved = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.resolved);
    this.picture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.SRGB8_ALPHA8, width, height);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.picture, 0);
  }

  private attach(format: GLenum, attachment: GLenum, samples: number): WebGLRenderbuffer {
    const { gl, width, height } = this;
    const buffer = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
    gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
    return buffer;
  }

  private release() {
    const { gl } = this;
    gl.deleteFramebuffer(this.drawn);
    gl.deleteFramebuffer(this.resolved);
    gl.deleteRenderbuffer(this.colour);
    gl.deleteRenderbuffer(this.depth);
    gl.deleteTexture(this.picture);
  }
}

/** @throws with the driver's message. */
export function linked(gl: WebGL2RenderingContext, vertex: string, fragment: string): WebGLProgram {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
      throw new Error(`The graphics driver refuses a shader: ${gl.getShaderInfoLog(shader)}`);
    gl.deleteShader(shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(`The graphics driver refuses a program: ${gl.getProgramInfoLog(program)}`);
  return program;
}
