// The functions that JavaScript calls (client/module.ts): one surface or scene for each instance of the
// module. Numbers that may be beyond 32 bits are f64; texts are UTF-8 in text_at(); several numbers go
// through an array of the caller's.

#include <emscripten.h>

#include <cmath>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>

#include "apps/web/web_scene.h"
#include "apps/web/web_surface.h"
#include "runtime/draw/surface_shaders.h"

namespace {

using namespace cuesta;

// One of the two.
std::unique_ptr<web::WebSurface> surface;
std::unique_ptr<web::WebScene> scene;
std::string text;

std::vector<std::byte> copied(const std::byte* bytes, std::uint32_t count) {
  return {bytes, bytes + count};
}

Vec3d vector_at(const double* n) {
  return {n[0], n[1], n[2]};
}

std::uint64_t limit(double n) {
  return n < 9e15 ? static_cast<std::uint64_t>(std::max(n, 0.0)) : std::numeric_limits<std::uint64_t>::max();
}

/// Eye, target, up, angle, width, height.
View view_at(const double* n) {
  return {vector_at(n), vector_at(n + 3),        vector_at(n + 6),
          n[9],         static_cast<int>(n[10]), static_cast<int>(n[11])};
}

web::Aim aim_at(const double* n) {
  web::Aim aim;
  aim.view = view_at(n);
  aim.tau_px = n[12];
  aim.exaggeration = n[13];
  aim.geomorph_ms = n[14];
  aim.budgets.triangles = limit(n[15]);
  aim.budgets.upload_bytes = limit(n[16]);
  aim.budgets.adapt_ms = n[17];
  return aim;
}

void put(const AdaptReport& r, double* out) {
  const double numbers[] = {static_cast<double>(r.triangles),
                            static_cast<double>(r.coarse_operations),
                            static_cast<double>(r.fine_operations),
                            static_cast<double>(r.pages_loaded),
                            static_cast<double>(r.pages_missing),
                            static_cast<double>(r.morphing),
                            r.tau,
                            r.achieved,
                            r.adapt_ms,
                            static_cast<double>(r.resident_bytes),
                            static_cast<double>(r.upload_bytes),
                            static_cast<double>(r.bound_by),
                            r.settled ? 1.0 : 0.0,
                            static_cast<double>(surface->cache().resident_ids().size()),
                            static_cast<double>(surface->cache().counters().evictions),
                            static_cast<double>(surface->cache().counters().failed)};
  std::copy(std::begin(numbers), std::end(numbers), out);
}

/// As far as a scene has it; what a cut does and a scene does not is 0.
void put(const web::WebScene::Step& step, double tau_px, double* out) {
  const SceneFrameReport& r = step.report;
  const Binding bound_by = r.store.waiting_for_budget > 0         ? Binding::resident_bytes
                           : r.outcome == ResolutionOutcome::full ? Binding::nothing
                                                                  : Binding::triangles;
  const double numbers[] = {static_cast<double>(r.drawn_triangles),
                            0,
                            0,
                            static_cast<double>(r.store.loaded),
                            static_cast<double>(r.store.missing),
                            0,
                            tau_px,
                            std::numeric_limits<double>::infinity(),
                            r.choice_ms,
                            static_cast<double>(r.store.resident_bytes),
                            static_cast<double>(step.words.size_bytes()),
                            static_cast<double>(bound_by),
                            step.settled ? 1.0 : 0.0,
                            static_cast<double>(r.drawn_objects),
                            static_cast<double>(r.store.evicted),
                            static_cast<double>(step.failed)};
  std::copy(std::begin(numbers), std::end(numbers), out);
}

void put(std::uint32_t id, const BlockRef& block, double*& out) {
  *out++ = id;
  *out++ = static_cast<double>(block.offset);
  *out++ = static_cast<double>(block.bytes);
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* text_at() {
  return text.c_str();
}

EMSCRIPTEN_KEEPALIVE void create(const char* name, double file_bytes, int is_scene) {
  const auto clock = [] { return emscripten_get_now(); };
  if (is_scene)
    scene = std::make_unique<web::WebScene>(name, limit(file_bytes), clock);
  else
    surface = std::make_unique<web::WebSurface>(name, limit(file_bytes), clock);
}

EMSCRIPTEN_KEEPALIVE void deliver(double offset, const std::byte* bytes, std::uint32_t count) {
  scene ? scene->deliver(limit(offset), copied(bytes, count))
        : surface->deliver(limit(offset), copied(bytes, count));
}

/// 0: open, and facts are in the text; 1: a range is lacking, out[0] its offset and out[1] its bytes; 2: the
/// text is why not.
EMSCRIPTEN_KEEPALIVE int open_surface(double cache_bytes, double* out) {
  try {
    const auto lacking = scene ? scene->open(limit(cache_bytes)) : surface->open(limit(cache_bytes));
    if (!lacking) {
      text = lacking.error().text();
      return 2;
    }
    if (*lacking) {
      out[0] = static_cast<double>((*lacking)->offset);
      out[1] = static_cast<double>((*lacking)->bytes);
      return 1;
    }
    text = scene ? scene->facts() : surface->facts();
    return 0;
  } catch (const std::bad_alloc&) {
    text = "the browser gives no more memory: choose a smaller budget (out of budget)";
    return 2;
  }
}

/// in: a view and the exaggeration; out: eye, target, up.
EMSCRIPTEN_KEEPALIVE void first_view(const double* in, double* out) {
  const View v = scene ? scene->first_view(view_at(in)) : surface->first_view(view_at(in), in[12]);
  const double numbers[] = {v.eye.x,    v.eye.y, v.eye.z, v.target.x, v.target.y,
                            v.target.z, v.up.x,  v.up.y,  v.up.z};
  std::copy(std::begin(numbers), std::end(numbers), out);
}

/// @return where the words are, out[0] how many; the report follows.
EMSCRIPTEN_KEEPALIVE const std::uint32_t* step(const double* in, double* out) {
  if (scene) {
    const web::Aim aim = aim_at(in);
    const auto step = scene->step(aim);
    out[0] = static_cast<double>(step.words.size());
    put(step, aim.tau_px, out + 1);
    return step.words.data();
  }
  const auto step = surface->step(aim_at(in));
  out[0] = static_cast<double>(step.words.size());
  put(step.report, out + 1);
  return step.words.data();
}

/// out: number (of a surface: the page), offset and bytes of each piece asked for, at most 64.
/// @return how many.
EMSCRIPTEN_KEEPALIVE std::uint32_t take_asked(double* out) {
  static_assert(web::WebScene::most_asked <= 64 && DeliveredLoader::usual_width <= 64);
  const double* const begin = out;
  if (scene)
    for (const auto& [id, block] : scene->take_asked()) put(id, block, out);
  else
    for (const PageId id : surface->take_asked()) put(id, surface->block(id), out);
  return static_cast<std::uint32_t>((out - begin) / 3);
}

EMSCRIPTEN_KEEPALIVE void bring(std::uint32_t page, const std::byte* bytes, std::uint32_t count) {
  scene ? scene->bring(page, copied(bytes, count)) : surface->bring(page, copied(bytes, count));
}

EMSCRIPTEN_KEEPALIVE void give_up(std::uint32_t page, const char* why) {
  if (scene)
    scene->give_up(page);
  else
    surface->give_up(page, {ErrorCode::io, "", "page " + std::to_string(page), why});
}

/// The text: the first page that could not be read, and why; empty without.
EMSCRIPTEN_KEEPALIVE void first_error() {
  if (scene) {
    text = scene->first_error();
    return;
  }
  const auto errors = surface->cache().errors();
  text = errors.empty() ? "" : errors.front().text();
}

/// in: origin, direction, exaggeration.   @return infinity if the ray meets nothing.
EMSCRIPTEN_KEEPALIVE double distance_along(const double* in) {
  const auto distance = scene ? scene->distance_along(vector_at(in), vector_at(in + 3))
                              : surface->distance_along(vector_at(in), vector_at(in + 3), in[6]);
  return distance.value_or(std::numeric_limits<double>::infinity());
}

/// in: a point and the exaggeration. The text is where it is.
EMSCRIPTEN_KEEPALIVE void place(const double* in) {
  text = scene ? "" : surface->place(vector_at(in), in[3]);
}

/// The text: a JSON object of [vertex, fragment] for each shading, in GLSL ES 3.00. Of a scene all but lit
/// and normals are as lit.
EMSCRIPTEN_KEEPALIVE void shaders(int fragment_depth) {
  nlohmann::json all;
  const std::pair<const char*, Shading> shadings[] = {{"lit", Shading::lit},
                                                      {"normals", Shading::normals},
                                                      {"pages", Shading::pages},
                                                      {"relief", Shading::relief}};
  for (const auto& [name, shading] : shadings) {
    const bool is_known = shading == Shading::lit || shading == Shading::normals;
    const auto sources = scene ? instance_shaders(is_known ? shading : Shading::lit, fragment_depth != 0,
                                                  ShaderDialect::es_300)
                               : surface_shaders(shading, fragment_depth != 0, ShaderDialect::es_300);
    all[name] = {sources.vertex, sources.fragment};
  }
  text = all.dump();
}
}
