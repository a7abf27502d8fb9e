// What crosses the borders of the package: views, aims, what is known of a surface, and what a step changes.

export type Vec3 = [number, number, number];

/** A camera, in the file's world and units; right-handed, `fovY` the full vertical angle in radians. */
export interface View {
  eye: Vec3;
  target: Vec3;
  up: Vec3;
  fovY: number;
  width: number; // pixels
  height: number;
}

/** What each step aims at. Budgets are limits: what is left undone goes on in the next step. */
export interface Aim {
  /** Error on the screen in pixels, > 0. */
  tau: number;
  triangles: number;
  /** Bytes of vertices and indices that one step changes. */
  uploadBytes: number;
  /** Milliseconds that a step computes, in the worker. */
  adaptMs: number;
  /** Milliseconds that a change of detail is blended over; 0: none. */
  geomorphMs: number;
  /** Terrain: heights are drawn at this times what they are. */
  exaggeration: number;
}

export const usualAim: Aim = {
  tau: 1,
  triangles: 2_000_000,
  uploadBytes: 4 << 20,
  adaptMs: 8,
  geomorphMs: 0,
  exaggeration: 1,
};

/** Which way is up, and the colours of heights, of a terrain; metres. A radius of 0: a plane. */
export interface ReliefFacts {
  origin: Vec3;
  axes: [Vec3, Vec3, Vec3];
  equatorialRadius: number;
  polarRadius: number;
  least: number;
  most: number;
  seaLevel: number;
  /** The vertices' colours are drawn, as of a draped image. */
  vertexColours: boolean;
}

export interface SurfaceFacts {
  vertices: number; // of the full resolution
  triangles: number;
  bytes: number; // of the file
  box: [Vec3, Vec3];
  /** Drawn positions are whole numbers: world = origin + step * position. */
  grid: { origin: Vec3; step: number };
  normals: boolean;
  colours: boolean;
  /** Of each page; 0 is the finest. */
  rounds: number[];
  /** Terrain only. */
  relief?: ReliefFacts;
  /** Scenes only: counts of vertices and triangles are those of all instances, and `grid` and `rounds` say nothing. */
  scene?: { parts: number; instances: number };
}

export type Binding = 'nothing' | 'adapt time' | 'triangles' | 'page loads' | 'resident bytes' | 'upload bytes';

/** What a step did, and what bound it. */
export interface Report {
  triangles: number;
  coarseOperations: number;
  fineOperations: number;
  pagesLoaded: number;
  pagesMissing: number; // wanted, but not there yet
  morphing: number;
  tau: number; // aimed at: the user's, or larger where a budget binds
  achieved: number; // bound of the error in pixels; infinite while it is not known
  adaptMs: number;
  residentBytes: number;
  uploadBytes: number;
  boundBy: Binding;
  /** Another step with the same view and aim would change nothing. */
  settled: boolean;
  residentPages: number; // of a scene: objects that are drawn
  evictions: number;
  failedPages: number;
}

/** What came over the network, and what the module takes. */
export interface Traffic {
  requests: number;
  bytes: number; // of bodies
  pages: number;
  /** Requests under way. */
  active: number;
  /** Linear memory of the module. */
  memoryBytes: number;
}

/** Vertex and fragment shader of each shading, as the native renderer's; GLSL ES 3.00. */
export type Shading = 'lit' | 'normals' | 'pages' | 'relief';
export type Shaders = Record<Shading, [string, string]>;

/** One step's change of what is drawn; applied whole it is a surface without cracks. Vertices are 20 bytes: three i32 of
 *  position (grid units), two i16 of an octahedral normal (both -32768: none), four u8 of sRGB colour. */
export interface Change {
  vertexCount: number; // of the whole pool
  indexCount: number;
  /** (first, count) pairs; later ones win. Their vertices follow each other in `vertices`. */
  vertexRanges: Uint32Array;
  vertices: Uint32Array;
  indexRanges: Uint32Array;
  indices: Uint32Array;
  /** What to draw: (first, count) pairs of the index pool, and the page of each. */
  draws: Uint32Array;
  drawPages: Uint32Array;
}

export const wordsOfVertex = 5;

/** One step's picture of a scene, and what of it is new. Vertices and triangles are as of Change; those of a part are on a
 *  grid of its own: place = origin + step * position, in the part's frame. */
export interface SceneChange {
  groups: SceneGroup[];
  /** Of each instance, 12 numbers: columns and translation of its map into the world. */
  maps: Float64Array;
  /** Of each instance: sRGB, multiplies the vertices'. */
  colours: Uint8Array;
  parts: { part: number; vertices: Uint32Array }[];
  blocks: { block: number; triangles: Uint32Array }[];
  forgottenParts: Uint32Array;
  forgottenBlocks: Uint32Array;
}

/** Instances of one part at one resolution, neighbours in `maps`. */
export interface SceneGroup {
  part: number;
  block: number;
  first: number;
  count: number;
  mirrored: boolean;
  origin: Vec3;
  step: number;
}

/** The words of a scene's step (web_scene.h) as views into them. */
export function sceneChangeOf(words: Uint32Array): SceneChange {
  const [parts, blocks, oldParts, oldBlocks, groups, instances] = words;
  let at = 8;
  const take = (count: number) => words.subarray(at, (at += count));
  const takeNumbers = (count: number) => {
    const taken = take(2 * count);
    return new Float64Array(taken.buffer, taken.byteOffset, count);
  };
  const grids = takeNumbers(4 * groups);
  const maps = takeNumbers(12 * instances);
  const colours = take(instances);
  const group = (_: unknown, i: number): SceneGroup => {
    const [part, block, first, count, mirrored] = take(5);
    const [x, y, z, step] = grids.subarray(4 * i, 4 * i + 4);
    return { part, block, first, count, mirrored: mirrored !== 0, origin: [x, y, z], step };
  };
  return {
    maps,
    colours: new Uint8Array(colours.buffer, colours.byteOffset, 4 * instances),
    groups: Array.from({ length: groups }, group),
    parts: Array.from({ length: parts }, () => {
      const [part, count] = take(2);
      return { part, vertices: take(count * wordsOfVertex) };
    }),
    blocks: Array.from({ length: blocks }, () => {
      const [block, count] = take(2);
      return { block, triangles: take(3 * count) };
    }),
    forgottenParts: take(oldParts),
    forgottenBlocks: take(oldBlocks),
  };
}

/** The words of a step (web_surface.h) as views into them. */
export function changeOf(words: Uint32Array): Change {
  const [vertexRanges, indexRanges, draws, vertexCount, indexCount] = words;
  let at = 5;
  const take = (count: number) => words.subarray(at, (at += count));
  const total = (ranges: Uint32Array) => {
    let sum = 0;
    for (let i = 1; i < ranges.length; i += 2) sum += ranges[i];
    return sum;
  };
  const v = take(2 * vertexRanges);
  const i = take(2 * indexRanges);
  return {
    vertexCount,
    indexCount,
    vertexRanges: v,
    indexRanges: i,
    draws: take(2 * draws),
    drawPages: take(draws),
    vertices: take(total(v) * wordsOfVertex),
    indices: take(total(i)),
  };
}

/** Calls back with each range, where it goes and where its elements are: `at` in the change's array. */
export function eachRange(ranges: Uint32Array, use: (first: number, count: number, at: number) => void) {
  for (let i = 0, at = 0; i < ranges.length; i += 2) {
    use(ranges[i], ranges[i + 1], at);
    at += ranges[i + 1];
  }
}

/** Where a surface's bytes are: an address, or a file of the user's. */
export type Source = string | Blob;

export type ToWorker =
  | { kind: 'open'; source: Source; name: string; wasm: string; cacheBytes: number }
  | { kind: 'step'; numbers: number[] }
  | { kind: 'ask'; id: number; question: 'firstView' | 'distance' | 'place'; numbers: number[] };

export type FromWorker =
  | { kind: 'opened'; facts: SurfaceFacts; shaders: { clipControl: Shaders; fragmentDepth: Shaders } }
  | { kind: 'stepped'; report: Report; words: Uint32Array; traffic: Traffic }
  | { kind: 'arrived' } // pages are there: another step has something to do
  | { kind: 'answer'; id: number; value: number[] | number | string }
  | { kind: 'trouble'; message: string } // it is tried again; empty: it is over
  | { kind: 'failed'; message: string };
