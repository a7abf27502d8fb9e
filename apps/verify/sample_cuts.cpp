#include "apps/verify/sample_cuts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "apps/measure/surface_distance.h"
#include "apps/verify/cut_shape.h"
#include "apps/verify/slot_points.h"
#include "runtime/cut.h"

namespace cuesta::verify {
namespace {

/// Shares of the removable triangles that uniform cuts keep.
constexpr std::array<double, 6> kept_shares{0.5, 0.2, 0.05, 0.01, 0.001, 0};
constexpr int view_count = 4;
/// Of the box's diagonal: what two evaluations in f64 may differ by.
constexpr double rounding_share = 1e-9;

double no_clock() {
  return 0;
}

std::vector<Triangle> triangles_of(const DrawList& list) {
  std::vector<Triangle> out;
  for (const Range& r : list.draws)
    for (std::uint32_t i = r.first; i < r.first + r.count; i += 3)
      out.push_back({list.indices[i], list.indices[i + 1], list.indices[i + 2]});
  return out;
}

/// A cut to look at: where from, and how fine.
struct Sample {
  std::string name;
  ErrorScale scale;
  double tau;
  const View* view;  // null: uniform
};

class CutSampler {
 public:
  CutSampler(const CuestaFile& file, Cut& cut, VerifyReport& report)
      : file_(file), cut_(cut), report_(report), grid_(cut.directory().grid) {}

  Result<void> run(const VerifyProgress& progress) {
    const auto full = settle(ErrorScale::uniform(grid_), -1);
    if (!full) return {};
    const DrawList list = cut_.draw_list();
    for (const DrawVertex& v : list.vertices) world_.push_back(grid_.world({v.x, v.y, v.z}));
    collect_originals(*full);
    auto points = slot_points(file_, cut_.cache(), world_.size());
    if (!points) return fail(points.error());
    points_ = *points;
    const SurfaceShape shape(std::move(*points), *full);
    check_full(*full, shape);
    make_views();
    const auto samples = choose_samples();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (progress && !progress(i, samples.size())) return fail(ErrorCode::cancelled, "", "", "stopped");
      check(samples[i], shape);
    }
    finish_ratios();
    return {};
  }

 private:
  /// The cut's triangles; nothing, and a finding, when it cannot be reached.
  std::optional<std::vector<Triangle>> settle(const ErrorScale& scale, double tau) {
    last_ = cut_.settle(scale, tau, {});
    if (!cut_.cache().errors().empty()) {
      report_.skipped.push_back("sample cuts: a page cannot be used: " +
                                cut_.cache().errors().front().text());
      return std::nullopt;
    }
    return triangles_of(cut_.draw_list());
  }

  void collect_originals(std::span<const Triangle> full) {
    std::vector<std::uint8_t> used(world_.size(), 0);
    for (const Triangle& t : full)
      for (std::uint32_t v : t) used[v] = 1;
    for (std::uint32_t v = 0; v < used.size(); ++v)
      if (used[v]) originals_.push_back(world_[v]);
  }

  void check_full(std::span<const Triangle> full, const SurfaceShape& shape) {
    const Directory& d = cut_.directory();
    if (full.size() != d.triangles || originals_.size() < d.vertices)
      report_.add(Check::crack_free, no_page, full.size(),
                  "at full resolution there are " + std::to_string(full.size()) + " triangles and " +
                      std::to_string(originals_.size()) + " vertices, the directory says " +
                      std::to_string(d.triangles) + " and " + std::to_string(d.vertices));
    for (const ComponentShape& c : shape.components())
      if (c.irregular_edges > 0)
        report_.add(Check::crack_free, no_page, c.irregular_edges, "the full surface has non-manifold edges");
  }

  /// From outside, and from near three of the vertices.
  void make_views() {
    Box3d box;
    for (const Vec3d& p : originals_) box.add(p);
    diagonal_ = length(box.hi - box.lo);
    const Vec3d centre = (box.lo + box.hi) / 2.0;
    for (int i = 0; i < view_count; ++i) {
      View& view = views_[static_cast<std::size_t>(i)];
      const Vec3d at = originals_[originals_.size() * static_cast<std::size_t>(i) / view_count];
      view.target = i == 0 ? centre : at;
      const Vec3d away = normalized(at - centre + Vec3d{0.3, 0.2, 0.1} * diagonal_);
      view.eye = view.target + away * (diagonal_ * (i == 0 ? 1.2 : 0.02 * i));
    }
  }

  std::vector<Sample> choose_samples() {
    std::vector<Sample> samples;
    const ErrorScale uniform = ErrorScale::uniform(grid_);
    for (const ErrorCode8 code : quantiles())
      samples.push_back({"uniform cut", uniform, uniform.sse(decode_error(code), {}), nullptr});
    for (std::size_t i = 0; i < views_.size(); ++i)
      for (const double tau : {1.0, 8.0})
        samples.push_back(
            {"view " + std::to_string(i), ErrorScale::perspective(grid_, views_[i]), tau, &views_[i]});
    return samples;
  }

  /// Errors at which the wanted shares of the removable triangles are left.
  std::vector<ErrorCode8> quantiles() {
    std::array<std::uint64_t, 256> removed{};
    std::uint64_t total = 0;
    for (PageId id : cut_.cache().resident_ids()) {
      const ResidentPage& page = *cut_.cache().resident(id);
      for (const FanState& fan : page.fans())
        for (const ChildState& c : page.children(fan)) {
          removed[c.error] += c.removed;
          total += c.removed;
        }
    }
    std::vector<ErrorCode8> codes;
    for (const double share : kept_shares) {
      std::uint64_t left = total;
      std::size_t code = 0;
      while (code < 255 && static_cast<double>(left -= removed[code]) > share * static_cast<double>(total))
        ++code;
      if (codes.empty() || codes.back() != code) codes.push_back(static_cast<ErrorCode8>(code));
    }
    return codes;
  }

  void check(const Sample& sample, const SurfaceShape& shape) {
    const auto triangles = settle(sample.scale, sample.tau);
    if (!triangles) return;
    ++report_.cuts;
    const std::string where = sample.name + ", tau " + std::to_string(sample.tau) + ", " +
                              std::to_string(triangles->size()) + " triangles: ";
    for (const std::string& complaint : shape.complaints(*triangles, ancestors(), topology_kept(sample)))
      report_.add(Check::crack_free, no_page, triangles->size(), where + complaint);
    if (last_.achieved > sample.tau)
      report_.add(Check::honest_error, no_page, triangles->size(),
                  where + "the error aimed at was not reached");
    check_error(sample, *triangles, where);
  }

  bool topology_kept(const Sample& sample) const {
    const double uniform_error = sample.view ? std::numeric_limits<double>::max() : sample.tau / grid_.step;
    return uniform_error < static_cast<double>(report_.topology_kept_below);
  }

  /// For each point the one that applied substitutions lead to. A point moves with all its wedges, also with
  /// those that no triangle used any more and so no substitution names.
  std::vector<std::uint32_t> ancestors() const {
    std::vector<std::uint32_t> up(world_.size());
    for (std::uint32_t v = 0; v < up.size(); ++v) up[v] = v;
    for (PageId id : cut_.cache().resident_ids()) {
      const ResidentPage& page = *cut_.cache().resident(id);
      for (const FanState& fan : page.fans())
        for (const ChildState& c : page.children(fan).first(fan.applied))
          up[points_[c.from_slot]] = points_[c.to_slot];
    }
    for (std::uint32_t& v : up)
      while (up[v] != v) v = up[v];
    return up;
  }

  void check_error(const Sample& sample, std::span<const Triangle> triangles, const std::string& where) {
    const auto distances = measure::point_distances(originals_, measure::TriangleTree(world_, triangles));
    double worst = 0;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const double noise = rounding_share * diagonal_;
      const double seen =
          sample.view ? sample.view->pixels_per_unit() / length(originals_[i] - sample.view->eye) : 1;
      worst = std::max(worst, (distances[i] - noise) * seen);
    }
    if (!sample.view && worst > 0) ratios_.push_back(last_.achieved / worst);
    if (worst > last_.achieved)
      report_.add(
          Check::honest_error, no_page, triangles.size(),
          where + "reported error " + std::to_string(last_.achieved) + ", measured " + std::to_string(worst));
  }

  void finish_ratios() {
    if (ratios_.empty()) return;
    std::sort(ratios_.begin(), ratios_.end());
    report_.median_bound_ratio = ratios_[ratios_.size() / 2];
  }

  const CuestaFile& file_;
  Cut& cut_;
  VerifyReport& report_;
  Grid grid_;
  AdaptReport last_;
  double diagonal_ = 0;
  std::vector<std::uint32_t> points_;  // per slot
  std::vector<Vec3d> world_, originals_;
  std::array<View, view_count> views_{};
  std::vector<double> ratios_;
};

}  // namespace

Result<void> verify_cuts(const CuestaFile& file, const SampleOptions& options, VerifyReport& report,
                         const VerifyProgress& progress) {
  if (file.directory().triangles > options.max_triangles) {
    report.skipped.push_back("sample cuts (I1, I5): " + std::to_string(file.directory().triangles) +
                             " triangles, the limit is " + std::to_string(options.max_triangles));
    return {};
  }
  auto cut = Cut::open(file, std::numeric_limits<std::uint64_t>::max(), no_clock);
  if (!cut) {
    report.skipped.push_back("sample cuts: the base page cannot be used: " + cut.error().text());
    return {};
  }
  return CutSampler(file, **cut, report).run(progress);
}

}  // namespace cuesta::verify
