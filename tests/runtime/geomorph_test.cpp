/// Blends of the fine path: what is drawn is always a legal cut, moves without jumps, and ends as it would
/// without.

#include "runtime/geomorph.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/runtime/corner_map.h"
#include "tests/runtime/open_file.h"

namespace cuesta::test {
namespace {

/// What a graphics card has that uploads only what it is told to.
class Mirror {
 public:
  void take(const DrawList& list) {
    if (vertices_.size() < list.vertices.size()) vertices_.assign(list.vertices.begin(), list.vertices.end());
    for (const Range& r : list.changed_vertices)
      std::copy_n(list.vertices.begin() + r.first, r.count, vertices_.begin() + r.first);
    for (const MorphedVertex& m : list.morphed) vertices_[m.slot] = m.vertex;
  }
  const DrawVertex& operator[](std::uint32_t slot) const { return vertices_[slot]; }

 private:
  std::vector<DrawVertex> vertices_;
};

Vec3d place(const DrawVertex& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

class Geomorph : public testing::TestWithParam<NamedSurface> {
 protected:
  void SetUp() override {
    build_file(GetParam().make(), folder_ / "a.cuesta");
    cut_ = open_cut(folder_ / "a.cuesta", unlimited, [this] { return now_ms_; });
    ASSERT_TRUE(cut_);
    cut_->settle(ErrorScale::uniform(cut_->directory().grid), -1, {});
    full_ = drawn_triangles(*cut_);
    cut_->set_path_policy(PathPolicy::always_fine);
    cut_->set_geomorph_ms(200);
  }
  ErrorScale scale_of(const View& view) { return ErrorScale::perspective(cut_->directory().grid, view); }
  bool legal() { return drawn_triangles(*cut_) == mapped_triangles(*cut_, full_); }

  TemporaryFolder folder_;
  double now_ms_ = 0;
  std::unique_ptr<Cut> cut_;
  Slots full_;
};

/// There and back, so that merges are called off and splits are merged again while they blend.
TEST_P(Geomorph, a_blending_cut_is_legal_and_the_card_shows_it) {
  std::mt19937 random(1);
  Mirror card;
  card.take(cut_->draw_list());
  std::size_t most = 0;
  for (int leg = 0; leg < 12; ++leg) {
    const View from = random_view(cut_->directory(), random);
    View to = random_view(cut_->directory(), random);
    for (int i = 0; i < 12; ++i) {
      View view = from;
      view.eye = from.eye + (to.eye - from.eye) * (i < 8 ? i / 20.0 : (16 - i) / 20.0);
      now_ms_ += 35;
      cut_->adapt(scale_of(view), 0.5 + leg % 3, {});
      const DrawList list = cut_->draw_list();
      card.take(list);
      std::map<std::uint32_t, DrawVertex> shown;
      for (const MorphedVertex& m : list.morphed) shown[m.slot] = m.vertex;
      most = std::max(most, shown.size());
      for (const Range& r : list.draws)
        for (std::uint32_t k = r.first; k < r.first + r.count; ++k) {
          const std::uint32_t slot = list.indices[k];
          const DrawVertex& expected = shown.contains(slot) ? shown[slot] : list.vertices[slot];
          ASSERT_EQ(place(card[slot]), place(expected)) << "leg " << leg << " frame " << i;
        }
      ASSERT_TRUE(legal()) << "leg " << leg << " frame " << i;
    }
  }
  if (full_.size() > 100) {
    EXPECT_GT(most, 0u);
  }
}

TEST_P(Geomorph, ends_at_the_cut_without_it) {
  std::mt19937 random(2);
  for (int i = 0; i < 4; ++i) {
    const View view = random_view(cut_->directory(), random);
    AdaptReport report;
    for (int frame = 0; frame < 400 && !report.settled; ++frame) {
      now_ms_ += 16;
      report = cut_->adapt(scale_of(view), 1, {});
    }
    ASSERT_TRUE(report.settled);
    EXPECT_EQ(report.morphing, 0u);
    const auto plain = open_cut(folder_ / "a.cuesta");
    plain->settle(ErrorScale::uniform(plain->directory().grid), -1, {});
    plain->settle(scale_of(view), 1, {});
    EXPECT_EQ(drawn_triangles(*cut_), drawn_triangles(*plain));
    EXPECT_TRUE(cut_->draw_list().morphed.empty());
  }
}

/// Merges that begin, are called off and begin again while others wait never wait for each other for good.
TEST_P(Geomorph, a_threshold_that_changes_while_it_blends_comes_to_rest) {
  std::mt19937 random(4);
  for (int i = 0; i < 10; ++i) {
    const ErrorScale scale = scale_of(random_view(cut_->directory(), random));
    double tau = 1;
    for (int change = 0; change < 20; ++change) {
      tau *= random() % 3 ? 1.2 : 0.6;
      for (unsigned frame = random() % 8; frame-- > 0;) {
        now_ms_ += 16;
        cut_->adapt(scale, tau, {});
        ASSERT_TRUE(legal()) << "view " << i << " change " << change;
      }
    }
    AdaptReport report;
    for (int frame = 0; frame < 1000 && !report.settled; ++frame) {
      now_ms_ += 16;
      report = cut_->adapt(scale, tau, {});
    }
    ASSERT_TRUE(report.settled) << "view " << i;
  }
}

/// A vertex that comes starts where its substitute is, one that goes ends there, and between frames none
/// moves more than a blend's share of its way.
TEST_P(Geomorph, nothing_jumps) {
  View view;
  const Directory& d = cut_->directory();
  view.target = d.grid.world({(d.lo.x + d.hi.x) / 2, (d.lo.y + d.hi.y) / 2, (d.lo.z + d.hi.z) / 2});
  const double size = length(d.grid.world(d.hi) - d.grid.world(d.lo));
  std::map<std::uint32_t, Vec3d> before;
  double longest_edge = 0;
  for (int frame = 0; frame < 160; ++frame) {
    now_ms_ += 10;
    const double distance = size * (frame < 80 ? 40 - 0.45 * frame : 4 + 0.45 * (frame - 80));
    view.eye = view.target + Vec3d{0, 0, distance};
    cut_->adapt(scale_of(view), 1, {});
    const DrawList list = cut_->draw_list();
    std::map<std::uint32_t, Vec3d> now;
    for (const Range& r : list.draws)
      for (std::uint32_t k = r.first; k < r.first + r.count; ++k)
        now[list.indices[k]] = place(list.vertices[list.indices[k]]);
    for (const MorphedVertex& m : list.morphed)
      if (now.contains(m.slot)) now[m.slot] = place(m.vertex);
    for (const Range& r : list.draws)
      for (std::uint32_t k = r.first; k < r.first + r.count; k += 3)
        longest_edge = std::max(longest_edge, length(now[list.indices[k]] - now[list.indices[k + 1]]));
    // 10 of 200 ms, at most 1.5 times the mean speed, and a substitute that moves itself.
    for (const auto& [slot, p] : now) {
      if (frame > 0 && before.contains(slot)) {
        ASSERT_LE(length(p - before[slot]), 0.2 * longest_edge + 2) << "frame " << frame;
      }
    }
    before = now;
  }
}

INSTANTIATE_TEST_SUITE_P(of, Geomorph, testing::ValuesIn(surfaces()),
                         [](const auto& s) { return s.param.name; });

}  // namespace
}  // namespace cuesta::test
