#include "tools/bench/fan_frame_rate.h"

#include <cmath>
#include <ctime>

#include "ooc/oct_normal.h"

namespace cuesta::bench {
namespace {

std::vector<DrawVertex> drawn_vertices(const baselines::ViewDependenceTree& tree) {
  std::vector<Vec3f> normals(tree.positions.size());
  for (const auto& t : tree.triangles) {
    const Vec3f &a = tree.positions[t[0]], &b = tree.positions[t[1]], &c = tree.positions[t[2]];
    for (const std::uint32_t v : t) normals[v] = normals[v] + cross(b - a, c - a);
  }
  std::vector<DrawVertex> vertices;
  vertices.reserve(normals.size());
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const Vec3f& p = tree.positions[v];
    const auto [u, w] = encode_oct(normals[v], 16);
    vertices.push_back({static_cast<std::int32_t>(std::lround(p.x)),
                        static_cast<std::int32_t>(std::lround(p.y)),
                        static_cast<std::int32_t>(std::lround(p.z)),
                        u,
                        w,
                        {255, 255, 255, 255}});
  }
  return vertices;
}

Result<std::unique_ptr<Renderer>> make_renderer() {
  auto context = make_osmesa_context();
  if (!context) return fail(context.error());
  return Renderer::create(std::move(*context));
}

/// Processor time of all threads of the process, which a software renderer has several of.
double process_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

Result<double> draw(Renderer& renderer, const DrawList& list, const View& view) {
  DrawOptions options;
  options.antialias = false;
  const double start = process_ms();
  if (auto drawn = renderer.draw(list, view, options); !drawn) return fail(drawn.error());
  if (auto read = renderer.read(); !read) return fail(read.error());
  return process_ms() - start;
}

}  // namespace

Result<FrameRate> FrameRate::create(const Grid& grid, const baselines::ViewDependenceTree& tree) {
  auto fan = make_renderer();
  if (!fan) return fail(fan.error());
  auto other = make_renderer();
  if (!other) return fail(other.error());
  return FrameRate(grid, tree, std::move(*fan), std::move(*other));
}

FrameRate::FrameRate(const Grid& grid, const baselines::ViewDependenceTree& tree,
                     std::unique_ptr<Renderer> fan, std::unique_ptr<Renderer> tree_renderer)
    : grid_(grid), vertices_(drawn_vertices(tree)), fan_(std::move(fan)), tree_(std::move(tree_renderer)) {}

Result<double> FrameRate::draw_fan(const DrawList& list, const View& view) {
  return draw(*fan_, list, view);
}

Result<double> FrameRate::draw_tree(std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const View& view) {
  const Range all_indices{0, static_cast<std::uint32_t>(triangles.size() * 3)};
  const std::span<const std::uint32_t> indices(triangles.data()->data(), all_indices.count);
  const std::span all(&all_indices, 1);
  const DrawList list{grid_, vertices_, {}, indices, all, {}, all};
  return draw(*tree_, list, view);
}

}  // namespace cuesta::bench
