#include "runtime/draw/surface_shaders.h"

namespace cuesta {
namespace {

/// What vertex shaders share.
constexpr const char* shared_vertex_text = R"(
uniform vec2 focal;
uniform float near_units;

/// A place in the camera's frame.
vec4 in_picture(vec3 p) {
  float distance = -p.z;
#ifdef FRAGMENT_DEPTH
  float depth = distance - 2.0 * near_units;  // clips at the near plane only
#else
  float depth = near_units;
#endif
  return vec4(focal * p.xy, depth, distance);
}

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
)";

constexpr const char* vertex_text = R"(
layout(location = 0) in ivec3 position;     // grid units
layout(location = 1) in ivec2 normal_code;  // octahedral
layout(location = 2) in vec4 colour;        // sRGB

uniform ivec3 eye_whole;
uniform vec3 eye_part;
uniform mat3 rotation;
uniform vec3 surface_colour;  // linear

INTERFACE(out, Surface, {
  vec3 position;  // camera frame, grid units
  vec3 normal;    // camera frame; zero: none
  vec3 colour;    // linear
}, surface);

uniform int relief_kind;  // relief_uniforms.h
uniform mat3 relief_to_radii;
uniform vec3 relief_eye;
uniform vec3 relief_up;
uniform vec3 relief_north;
uniform float relief_excess;
uniform float relief_eye_height;
uniform float exaggeration;
#ifdef RELIEF
uniform float unit;  // world units per grid unit
uniform float sea_level;  // world units

INTERFACE(out, Place, {
  vec3 up;    // camera frame
  vec3 north;
  float height;  // above the sea, world units
}, place);
#endif

/// Up and height, grid units, of a point at d from the eye (Relief::height).
vec3 relief_at(vec3 d, out float height) {
  if (relief_kind == 1) {
    height = relief_eye_height + dot(relief_up, d);
    return relief_up;
  }
  vec3 s = relief_to_radii * d;
  float excess = relief_excess + 2.0 * dot(relief_eye, s) + dot(s, s);
  float size = sqrt(max(1.0 + excess, 0.0));
  vec3 slope = (relief_eye + s) * relief_to_radii;
  float steepness = max(length(slope), 1e-30);
  height = excess / (1.0 + size) * size / steepness;
  return slope / steepness;
}

void main() {
  vec3 from_eye = vec3(position - eye_whole) - eye_part;
  vec3 normal = decode_normal(normal_code);
  float height;
  vec3 up = relief_at(from_eye, height);
  from_eye += up * ((exaggeration - 1.0) * height);
  normal += up * ((1.0 / exaggeration - 1.0) * dot(up, normal));
#ifdef RELIEF
  place.up = rotation * up;
  place.north = rotation * (relief_kind == 1 ? relief_north : relief_north - up * dot(relief_north, up));
  place.height = height * unit - sea_level;
#endif
  surface.position = rotation * from_eye;
  surface.normal = rotation * normal;
  surface.colour = linear_from_srgb(colour.rgb) * surface_colour;
  gl_Position = in_picture(surface.position);
}
)";

/// A vertex of a part, as an instance of it shows it.
constexpr const char* instance_vertex_text = R"(
layout(location = 0) in ivec3 position;     // grid units
layout(location = 1) in ivec2 normal_code;  // octahedral
layout(location = 2) in vec4 colour;        // sRGB
// Rows of the map from grid units about the anchor to the camera's frame, in world units.
layout(location = 3) in vec4 to_right;
layout(location = 4) in vec4 to_up;
layout(location = 5) in vec4 to_back;
layout(location = 6) in vec4 tint;  // linear

uniform ivec3 anchor;
uniform vec3 surface_colour;  // linear

INTERFACE(out, Surface, {
  vec3 position;  // camera frame, world units
  vec3 normal;    // camera frame; zero: none
  vec3 colour;    // linear
}, surface);

void main() {
  vec3 n = decode_normal(normal_code);
  vec4 p = vec4(vec3(position - anchor), 1.0);
  surface.position = vec3(dot(to_right, p), dot(to_up, p), dot(to_back, p));
  // The inverse transpose but for its length; rows here, so products of them.
  vec3 turned = vec3(dot(cross(to_up.xyz, to_back.xyz), n), dot(cross(to_back.xyz, to_right.xyz), n),
                     dot(cross(to_right.xyz, to_up.xyz), n));
  float size = length(turned);
  surface.normal = size > 0.0 ? turned / size : vec3(0.0);
  if (dot(to_right.xyz, cross(to_up.xyz, to_back.xyz)) < 0.0) surface.normal = -surface.normal;
  surface.colour = linear_from_srgb(colour.rgb) * surface_colour * tint.rgb;
  gl_Position = in_picture(surface.position);
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
INTERFACE(in, Surface, {
  vec3 position;
  vec3 normal;
  vec3 colour;
}, surface);

uniform float near_units;
uniform vec3 key_direction;   // camera frame, unit, towards the light
uniform vec3 fill_direction;

#ifdef RELIEF
INTERFACE(in, Place, {
  vec3 up;
  vec3 north;
  float height;
}, place);

uniform float shore;       // world units above the sea: up to it, it is sea
uniform float sea_floor;   // <= 0
uniform float land_least;
uniform float land_most;
uniform int vertex_colours;
#endif
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

#ifdef RELIEF
const int land_count = 8;
const float land_at[land_count] = float[](0.0, 0.10, 0.24, 0.40, 0.56, 0.72, 0.86, 1.0);
const vec3 land[land_count] = vec3[](  // linear
    vec3(0.120, 0.230, 0.090), vec3(0.195, 0.315, 0.125), vec3(0.430, 0.450, 0.205), vec3(0.480, 0.345, 0.150),
    vec3(0.325, 0.200, 0.105), vec3(0.300, 0.255, 0.225), vec3(0.660, 0.660, 0.680), vec3(0.920, 0.935, 0.960));
const vec3 shallow_water = vec3(0.270, 0.500, 0.640);
const vec3 middle_water = vec3(0.070, 0.235, 0.450);
const vec3 deep_water = vec3(0.012, 0.060, 0.190);

vec3 height_colour(float height) {
  if (height <= shore) {
    float depth = sqrt(clamp(height / min(sea_floor, -1.0), 0.0, 1.0));  // shelves show
    return depth < 0.5 ? mix(shallow_water, middle_water, 2.0 * depth)
                       : mix(middle_water, deep_water, 2.0 * depth - 1.0);
  }
  float t = clamp((height - land_least) / (land_most - land_least), 0.0, 1.0);
  vec3 colour = land[0];
  for (int i = 1; i < land_count; ++i)
    colour = mix(colour, land[i], clamp((t - land_at[i - 1]) / (land_at[i] - land_at[i - 1]), 0.0, 1.0));
  return colour;
}

/// Lit from the north-west, 40 degrees high, wherever it is seen from; level ground keeps its colour.
vec3 hill_shaded(vec3 n, vec3 colour) {
  const float level = 0.6428;  // sine of the light's height
  vec3 up = normalize(place.up);
  vec3 north = place.north / max(length(place.north), 1e-6);
  vec3 light = up * level + (north - cross(north, up)) * (0.7071 * 0.7660);
  float key = max(dot(n, light), 0.0) / level;
  float sky = 0.5 + 0.5 * dot(n, up);
  return colour * (0.80 * key * vec3(1.02, 1.0, 0.95) + 0.20 * sky * vec3(0.90, 1.0, 1.22));
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
#elif defined(RELIEF)
  vec3 own_colour = vertex_colours != 0 ? surface.colour : height_colour(place.height);
#else
  vec3 own_colour = surface.colour;
#endif
#ifdef TWO_SIDED
  vec3 colour = own_colour;
#else
  vec3 colour = gl_FrontFacing ? own_colour : back_face_colour;
#endif
#ifdef NORMALS
  vec3 coded = 0.5 + 0.5 * n;  // the target encodes sRGB: undo it, so that the stored bytes are the normal
  vec3 shade = mix(coded / 12.92, pow((coded + 0.055) / 1.055, vec3(2.4)), greaterThan(coded, vec3(0.04045)));
#elif defined(RELIEF)
  vec3 shade = hill_shaded(n, colour);
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
INTERFACE(in, Surface, {
  vec3 position;
  vec3 normal;
  vec3 colour;
}, surface);

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

// OpenGL ES 3.0 has no blocks between its two stages, but structures; geometry shaders need blocks.
constexpr const char* core_head = R"(#version 330 core
#define INTERFACE(way, Name, members, name) way Name members name
)";
constexpr const char* es_head = R"(#version 300 es
precision highp float;
precision highp int;
#define INTERFACE(way, Name, members, name) struct Name members; way Name name
)";

std::string head_of(bool fragment_depth, ShaderDialect dialect = ShaderDialect::core_330) {
  return std::string(dialect == ShaderDialect::core_330 ? core_head : es_head) +
         (fragment_depth ? "#define FRAGMENT_DEPTH\n" : "");
}

std::string define_of(Shading shading) {
  switch (shading) {
    case Shading::normals:
      return "#define NORMALS\n";
    case Shading::wireframe:
      return "#define WIREFRAME\n";
    case Shading::changes:
      return "#define CHANGES\n";
    case Shading::pages:
      return "#define PAGES\n";
    case Shading::relief:
      return "#define RELIEF\n";
    case Shading::lit:
      break;
  }
  return "";
}

}  // namespace

ShaderSources page_number_shaders(bool fragment_depth) {
  const std::string head = head_of(fragment_depth);
  return {head + shared_vertex_text + vertex_text, "", head + page_number_text};
}

ShaderSources surface_shaders(Shading shading, bool fragment_depth, ShaderDialect dialect) {
  const std::string head = head_of(fragment_depth, dialect) + define_of(shading);
  return {head + shared_vertex_text + vertex_text,
          shading == Shading::wireframe ? head + wireframe_geometry_text : "", head + fragment_text};
}

ShaderSources instance_shaders(Shading shading, bool fragment_depth, ShaderDialect dialect) {
  const std::string head = head_of(fragment_depth, dialect) + define_of(shading) + "#define TWO_SIDED\n";
  return {head + shared_vertex_text + instance_vertex_text,
          shading == Shading::wireframe ? head + wireframe_geometry_text : "", head + fragment_text};
}

}  // namespace cuesta
