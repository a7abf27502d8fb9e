#include "runtime/draw/surface_shaders.h"

namespace cuesta {
namespace {

constexpr const char* vertex_text = R"(
layout(location = 0) in ivec3 position;     // grid units
layout(location = 1) in ivec2 normal_code;  // octahedral
layout(location = 2) in vec4 colour;        // sRGB

uniform ivec3 eye_whole;
uniform vec3 eye_part;
uniform mat3 rotation;
uniform vec2 focal;
uniform float near_units;
uniform vec3 surface_colour;  // linear

out Surface {
  vec3 position;  // camera frame, grid units
  vec3 normal;    // camera frame; zero: none
  vec3 colour;    // linear
} surface;

vec3 decode_normal(ivec2 code) {
  if (code == ivec2(-32768)) return vec3(0.0);
  vec2 uv = vec2(code) / 32767.0;
  float z = 1.0 - abs(uv.x) - abs(uv.y);
  float fold = max(-z, 0.0);
  return normalize(vec3(uv.x + (uv.x >= 0.0 ? -fold : fold), uv.y + (uv.y >= 0.0 ? -fold : fold), z));
}

vec3 linear_from_srgb(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

void main() {
  surface.position = rotation * (vec3(position - eye_whole) - eye_part);
  surface.normal = rotation * decode_normal(normal_code);
  surface.colour = linear_from_srgb(colour.rgb) * surface_colour;
  float distance = -surface.position.z;
#ifdef FRAGMENT_DEPTH
  float depth = distance - 2.0 * near_units;  // clips at the near plane only
#else
  float depth = near_units;
#endif
  gl_Position = vec4(focal * surface.position.xy, depth, distance);
}
)";

/// Numbers the corners of each triangle, for the distance from its edges.
constexpr const char* wireframe_geometry_text = R"(
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

in Surface {
  vec3 position;
  vec3 normal;
  vec3 colour;
} corner[3];

out Surface {
  vec3 position;
  vec3 normal;
  vec3 colour;
} surface;
out vec3 barycentric;

void main() {
  for (int i = 0; i < 3; ++i) {
    surface.position = corner[i].position;
    surface.normal = corner[i].normal;
    surface.colour = corner[i].colour;
    barycentric = vec3(i == 0, i == 1, i == 2);
    gl_Position = gl_in[i].gl_Position;
    EmitVertex();
  }
  EndPrimitive();
}
)";

constexpr const char* fragment_text = R"(
in Surface {
  vec3 position;
  vec3 normal;
  vec3 colour;
} surface;

uniform float near_units;
uniform vec3 key_direction;   // camera frame, unit, towards the light
uniform vec3 fill_direction;

#ifdef PAGES
uniform int page;
#endif
#ifdef CHANGES
uniform usamplerBuffer triangle_tags;  // one per triangle of the pool
uniform int tag_count;
uniform int first_triangle;            // of the range that is drawn
#endif

out vec4 pixel;

#ifdef PAGES
/// Successive numbers get hues far apart, and three brightnesses.
vec3 page_colour() {
  float turn = 6.2831853 * fract(float(page) * 0.61803399);
  vec3 hue = 0.5 + 0.5 * cos(turn + vec3(0.0, 2.0944, 4.1888));
  return mix(vec3(0.55), hue, 0.75) * (1.0 - 0.22 * float(page % 3));
}
#endif
#ifdef CHANGES
/// Unchanged light, the coarse path grey, the fine path dark: Figures 8 to 10 of the fan-hierarchy paper.
vec3 change_colour() {
  const vec3 shades[3] = vec3[3](vec3(0.80), vec3(0.28), vec3(0.03));
  int triangle = first_triangle + gl_PrimitiveID;
  uint tag = triangle < tag_count ? texelFetch(triangle_tags, triangle).r : 0u;
  return shades[min(tag, 2u)];
}
#endif

const vec3 key_light = vec3(0.91, 0.86, 0.77);
const vec3 fill_light = vec3(0.115, 0.145, 0.190);
const vec3 sky_light = vec3(0.130, 0.142, 0.165);
const vec3 ground_light = vec3(0.040, 0.034, 0.030);
const vec3 back_face_colour = vec3(0.13, 0.21, 0.40);

/// Towards the viewer's side of the surface as its winding tells; facets without vertex normals.
vec3 shading_normal() {
  if (dot(surface.normal, surface.normal) > 1e-6)
    return normalize(gl_FrontFacing ? surface.normal : -surface.normal);
  vec3 facet = cross(dFdx(surface.position), dFdy(surface.position));
  return dot(facet, facet) > 0.0 ? normalize(facet) : vec3(0.0, 0.0, 1.0);
}

vec3 lit(vec3 n, vec3 colour) {
  vec3 to_eye = normalize(-surface.position);
  float key = max(0.86 * dot(n, key_direction) + 0.14, 0.0);  // a large lamp: past the terminator
  float fill = 0.5 + 0.5 * dot(n, fill_direction);
  float shine = key > 0.0 ? max(dot(n, normalize(key_direction + to_eye)), 0.0) : 0.0;
  shine *= shine;
  shine *= shine;
  shine *= shine;  // 8
  float glint = shine * shine * shine * shine;  // 32
  float grazing = 1.0 - max(dot(n, to_eye), 0.0);
  float rim = grazing * grazing * grazing;
  vec3 diffuse = key * key_light + fill * fill * fill_light + mix(ground_light, sky_light, 0.5 + 0.5 * n.y);
  return colour * diffuse + key_light * (0.04 * shine + 0.08 * glint) + rim * 0.35 * sky_light;
}

#ifdef WIREFRAME
in vec3 barycentric;

const vec3 line_colour = vec3(0.022, 0.032, 0.05);
const float half_width_px = 0.55;

/// 1 on an edge, 0 in the middle. Where triangles are only a few pixels high the lines get fainter, so that a dense mesh
/// becomes a tone and not a black patch.
float edge_coverage() {
  vec3 x = dFdx(barycentric);
  vec3 y = dFdy(barycentric);
  vec3 per_px = max(sqrt(x * x + y * y), vec3(1e-9));
  vec3 distance_px = barycentric / per_px;
  float height_px = 1.0 / max(per_px.x, max(per_px.y, per_px.z));
  float nearest = min(distance_px.x, min(distance_px.y, distance_px.z));
  return (1.0 - smoothstep(half_width_px - 0.5, half_width_px + 0.5, nearest)) * mix(0.25, 0.9, smoothstep(1.0, 9.0, height_px));
}
#endif

void main() {
  vec3 n = shading_normal();
#if defined(PAGES)
  vec3 own_colour = page_colour();
#elif defined(CHANGES)
  vec3 own_colour = change_colour();
#else
  vec3 own_colour = surface.colour;
#endif
  vec3 colour = gl_FrontFacing ? own_colour : back_face_colour;
#ifdef NORMALS
  vec3 coded = 0.5 + 0.5 * n;  // the target encodes sRGB: undo it, so that the stored bytes are the normal
  vec3 shade = mix(coded / 12.92, pow((coded + 0.055) / 1.055, vec3(2.4)), greaterThan(coded, vec3(0.04045)));
#else
  vec3 shade = lit(n, colour);
#endif
#ifdef WIREFRAME
  shade = mix(shade, line_colour, edge_coverage());
#endif
  pixel = vec4(shade, 1.0);
#ifdef FRAGMENT_DEPTH
  gl_FragDepth = near_units / -surface.position.z;
#endif
}
)";

constexpr const char* page_number_text = R"(
in Surface {
  vec3 position;
  vec3 normal;
  vec3 colour;
} surface;

uniform float near_units;
uniform int page;

out uint number;

void main() {
  number = uint(page) + 1u;
#ifdef FRAGMENT_DEPTH
  gl_FragDepth = near_units / -surface.position.z;
#endif
}
)";

std::string head_of(bool fragment_depth) {
  return std::string("#version 330 core\n") + (fragment_depth ? "#define FRAGMENT_DEPTH\n" : "");
}

}  // namespace

ShaderSources page_number_shaders(bool fragment_depth) {
  const std::string head = head_of(fragment_depth);
  return {head + vertex_text, "", head + page_number_text};
}

ShaderSources surface_shaders(Shading shading, bool fragment_depth) {
  std::string head = head_of(fragment_depth);
  if (shading == Shading::normals) head += "#define NORMALS\n";
  if (shading == Shading::wireframe) head += "#define WIREFRAME\n";
  if (shading == Shading::changes) head += "#define CHANGES\n";
  if (shading == Shading::pages) head += "#define PAGES\n";
  ShaderSources sources{head + vertex_text, "", head + fragment_text};
  if (shading == Shading::wireframe) sources.geometry = head + wireframe_geometry_text;
  return sources;
}

}  // namespace cuesta
