#include "apps/sample/finest_surface.h"

#include <algorithm>
#include <cmath>

#include "ooc/check.h"

namespace cuesta::sample {
namespace {

constexpr std::size_t most_pages = 64;
constexpr std::uint64_t positions_bytes = std::uint64_t{64} << 20;
constexpr double bound_slack = 1e-6;  // of a page's radius, as bounds are single floats

struct Point2 {
  double x = 0, y = 0;
};
double cross(Point2 a, Point2 b) {
  return a.x * b.y - a.y * b.x;
}
double dot(Point2 a, Point2 b) {
  return a.x * b.x + a.y * b.y;
}

/// A point of a triangle: shares of its three corners.
struct Foot {
  std::array<double, 3> shares{};
  double distance = 0;  ///< in the picture along the line; 0: the line meets the triangle
};

/// A segment, and pictures along it in which it is the origin. A vertex has the same picture in all triangles
/// and an edge the same sign from both sides, but for the order: so no line passes between two neighbours.
class Line {
 public:
  Line(Vec3d from, Vec3d to) : from_(from), length_(length(to - from)), along_((to - from) / length_) {
    const Vec3d aside = std::abs(along_.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    x_ = normalized(cuesta::cross(along_, aside));
    y_ = cuesta::cross(along_, x_);
  }
  bool may_meet(const Sphere& s, double slack) const {
    const Vec3d to = vec_cast<double>(s.centre) - from_;
    const double radius = static_cast<double>(s.radius) * (1 + bound_slack) + slack;
    const double at = std::clamp(cuesta::dot(to, along_), 0.0, length_);
    return length(to - along_ * at) <= radius;
  }
  Point2 picture(Vec3d p) const { return {cuesta::dot(x_, p - from_), cuesta::dot(y_, p - from_)}; }
  double along(Vec3d p) const { return cuesta::dot(along_, p - from_); }
  double size() const { return length_; }

 private:
  Vec3d from_;
  double length_;
  Vec3d along_, x_, y_;
};

/// The point of the edge from corner i to the next that is nearest to the origin.
Foot foot_on_edge(const std::array<Point2, 3>& c, std::size_t i) {
  const std::size_t j = (i + 1) % 3;
  const Point2 edge{c[j].x - c[i].x, c[j].y - c[i].y};
  const double size2 = dot(edge, edge);
  const double t = size2 > 0 ? std::clamp(-dot(c[i], edge) / size2, 0.0, 1.0) : 0;
  Foot foot;
  foot.shares[i] = 1 - t;
  foot.shares[j] = t;
  foot.distance = std::hypot(c[i].x + edge.x * t, c[i].y + edge.y * t);
  return foot;
}

Foot foot_on(const std::array<Point2, 3>& c) {
  const std::array<double, 3> areas{cross(c[1], c[2]), cross(c[2], c[0]), cross(c[0], c[1])};
  const double sum = areas[0] + areas[1] + areas[2];
  const bool inside =
      (areas[0] >= 0 && areas[1] >= 0 && areas[2] >= 0) || (areas[0] <= 0 && areas[1] <= 0 && areas[2] <= 0);
  if (inside && sum != 0) return {{areas[0] / sum, areas[1] / sum, areas[2] / sum}, 0};
  Foot best = foot_on_edge(c, 0);
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}})
    if (const Foot foot = foot_on_edge(c, i); foot.distance < best.distance) best = foot;
  return best;
}

/// Nearest in the picture, then nearest to the segment's end.
struct Best {
  double distance, along = -1;
  bool found = false;

  void look(const Line& line, const std::array<Vec3d, 3>& corners) {
    const std::array<Point2, 3> c{line.picture(corners[0]), line.picture(corners[1]),
                                  line.picture(corners[2])};
    const auto [least_x, most_x] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [least_y, most_y] = std::minmax({c[0].y, c[1].y, c[2].y});
    if (least_x > distance || most_x < -distance || least_y > distance || most_y < -distance) return;
    const Foot foot = foot_on(c);
    double at = 0;
    for (std::size_t i = 0; i < 3; ++i) at += foot.shares[i] * line.along(corners[i]);
    if (at < 0 || at > line.size() || foot.distance > distance) return;
    if (found && foot.distance == distance && at <= along) return;
    distance = foot.distance;
    along = at;
    found = true;
  }
};

}  // namespace

FinestSurface::FinestSurface(const CuestaFile& file) : file_(file), positions_(file, positions_bytes) {
  const auto& pages = file.directory().pages;
  for (PageId id = 0; id < pages.size(); ++id)
    if (pages[id].round == 0) finest_.push_back(id);
}

Result<const FinestSurface::Loaded*> FinestSurface::load(PageId id) {
  const auto is_it = [id](const Loaded& l) { return l.id == id; };
  if (const auto at = std::find_if(loaded_.begin(), loaded_.end(), is_it); at != loaded_.end()) {
    loaded_.splice(loaded_.begin(), loaded_, at);
    return &loaded_.front();
  }
  const auto survivors = positions_.survivors(id);
  if (!survivors)
    return fail(ErrorCode::corrupt, file_.path().string(), "page " + std::to_string(id),
                positions_.complaint().empty() ? "a page that it leans on cannot be read; run cuesta verify"
                                               : positions_.complaint());
  auto page = file_.read_page(id, *survivors);
  if (!page) return fail(page.error());
  ++pages_read_;
  loaded_.push_front({id, std::move(page->triangles), local_positions(*page)});
  if (loaded_.size() > most_pages) loaded_.pop_back();
  return &loaded_.front();
}

Result<std::optional<Vec3d>> FinestSurface::meet(Vec3d from, Vec3d to) {
  CUESTA_CHECK(length(to - from) > 0);
  const Grid& grid = file_.directory().grid;
  const double slack = grid.snap_error() / grid.step;
  const Vec3d start = (from - grid.origin) / grid.step, end = (to - grid.origin) / grid.step;
  const Line line(start, end);
  Best best{.distance = slack};
  for (const PageId id : finest_) {
    if (!line.may_meet(file_.directory().pages[id].bound, slack)) continue;
    const auto page = load(id);
    if (!page) return fail(page.error());
    const auto& positions = (*page)->positions;
    for (const auto& t : (*page)->triangles)
      best.look(line, {vec_cast<double>(positions[t[0]]), vec_cast<double>(positions[t[1]]),
                       vec_cast<double>(positions[t[2]])});
  }
  if (!best.found) return std::optional<Vec3d>();
  return std::optional<Vec3d>(from + (to - from) * (best.along / line.size()));
}

}  // namespace cuesta::sample
