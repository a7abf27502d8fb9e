export type {
  Aim,
  Change,
  ReliefFacts,
  Report,
  SceneChange,
  SceneGroup,
  Shaders,
  Shading,
  Source,
  SurfaceFacts,
  Traffic,
  Vec3,
  View,
} from './types.ts';
export { eachRange, usualAim, wordsOfVertex } from './types.ts';
export { CuestaSurface, type OpenOptions } from './surface.ts';
export { type DrawOptions, SurfaceRenderer } from './renderer.ts';
export { SceneRenderer } from './scene_renderer.ts';
export { CameraControls, type ControlMode } from './controls.ts';
export type { Lighting } from './uniforms.ts';
