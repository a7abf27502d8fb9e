#pragma once
/// Several files in one world, each with its own cut, under one set of budgets.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/cut.h"

namespace cuesta::view {

class Scene {
 public:
  struct Object {
    std::string name;
    std::unique_ptr<Cut> cut;
    std::vector<Vec3d> points;  ///< of its surface, a few
    Vec3d centre;
    double radius;
    AdaptReport report;
  };

  /// @param points  of its surface, not empty.
  void add(std::string name, std::unique_ptr<Cut> cut, std::vector<Vec3d> points);
  std::span<const Object> objects() const { return objects_; }

  /// How adapt() goes about it.
  struct Options {
    double tau_px = 1;
    double outside_factor = 4;
    Budgets budgets;
    double geomorph_ms = 0;
    bool only_visible = true;           ///< lists() leave out pages that the view cannot show
    bool tags = false;                  ///< lists() say how triangles came to be drawn
    std::optional<Relief> relief = {};  ///< how heights are drawn exaggerated; hit() knows it, too
  };
  /// Adapts every object once, with its share of the budgets.
  /// @return true if what is drawn has changed since lists() was drawn last.
  bool adapt(const View& view, const Options& options);
  /// Leaves nothing out of lists(), whatever the view was.
  void list_all();
  /// What to draw after the last adapt(); until the next. An object's place stays.
  std::span<const DrawList> lists() const { return lists_; }
  /// The lists have been drawn: the changes in them are on the GPU.
  void mark_drawn();

  /// Sums over the objects; largest tau and error.
  AdaptReport report() const;
  std::uint64_t resident_pages() const;
  std::uint64_t cache_bytes() const;
  std::uint64_t unreadable_pages() const;
  /// Of all objects.
  std::vector<Vec3d> points() const;
  double diagonal() const;
  /// The nearest surface along a ray, as it is drawn.
  std::optional<Vec3d> hit(Vec3d origin, Vec3d direction) const;

 private:
  std::vector<Object> objects_;
  std::vector<DrawList> lists_;
  std::optional<Relief> relief_;  ///< of the last adapt()
};

}  // namespace cuesta::view
