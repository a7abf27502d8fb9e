/// All patterns of voids of a small patch, against what triangles make of themselves.

#include "terrain/lattice_patch.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace cuesta {
namespace {

using Corner = LatticePatch::Corner;
using Point = std::array<std::uint32_t, 2>;
using Vertex = std::array<std::uint32_t, 3>;

Point point(const Corner& c) {
  return {c.x, c.y};
}
Vertex vertex(const Corner& c) {
  return {c.x, c.y, c.fan};
}

/// A square of 3 × 3 cells whose 16 postings are the bits of `pattern`, row by row, with nothing around it.
struct Pattern {
  static constexpr std::uint32_t side = 3;

  explicit Pattern(std::uint32_t bits) : bits_(bits) {
    for (std::uint32_t y = 0; y <= side; ++y)
      for (std::uint32_t x = 0; x <= side; ++x) has_height_[(y + 1) * (side + 3) + x + 1] = has(x, y);
  }
  bool has(std::uint32_t x, std::uint32_t y) const { return bits_ >> (y * (side + 1) + x) & 1; }
  std::span<const std::uint8_t> has_height() const { return has_height_; }
  /// Cells with 4 postings make 2 triangles, with 3 one.
  std::size_t triangles() const {
    std::size_t count = 0;
    for (std::uint32_t y = 0; y < side; ++y)
      for (std::uint32_t x = 0; x < side; ++x) {
        const int corners = has(x, y) + has(x + 1, y) + has(x, y + 1) + has(x + 1, y + 1);
        count += corners == 4 ? 2 : corners == 3;
      }
    return count;
  }

 private:
  std::uint32_t bits_;
  std::array<std::uint8_t, (side + 3) * (side + 3)> has_height_{};
};

std::vector<std::array<Corner, 3>> triangles_of(const LatticePatch& patch) {
  std::vector<std::array<Corner, 3>> out;
  patch.for_triangles([&](const std::array<Corner, 3>& t) { out.push_back(t); });
  return out;
}

/// How many fans the triangles around a posting are: sets that are joined by edges from it.
std::size_t fans_at(Point at, const std::vector<std::array<Corner, 3>>& triangles) {
  std::vector<std::set<Point>> fans;
  for (const auto& t : triangles) {
    std::set<Point> others;
    bool uses = false;
    for (const Corner& c : t) point(c) == at ? void(uses = true) : void(others.insert(point(c)));
    if (!uses) continue;
    for (auto fan = fans.begin(); fan != fans.end();) {
      const bool joined = std::any_of(fan->begin(), fan->end(), [&](Point p) { return others.contains(p); });
      if (joined) others.insert(fan->begin(), fan->end());
      fan = joined ? fans.erase(fan) : fan + 1;
    }
    fans.push_back(others);
  }
  return fans.size();
}

/// Called with every pattern; stops at the first failure.
template <class Check>
void for_patterns(Check check) {
  for (std::uint32_t bits = 0; bits < 1u << 16; ++bits) {
    const Pattern pattern(bits);
    check(pattern, LatticePatch(Pattern::side, Pattern::side, pattern.has_height()));
    ASSERT_FALSE(testing::Test::HasFailure()) << "pattern " << std::hex << bits;
  }
}

TEST(LatticePatch, cells_with_three_postings_make_one_triangle_and_with_four_two) {
  for_patterns([](const Pattern& pattern, const LatticePatch& patch) {
    const auto triangles = triangles_of(patch);
    EXPECT_EQ(triangles.size(), pattern.triangles());
    for (const auto& t : triangles)
      for (const Corner& c : t) EXPECT_TRUE(pattern.has(c.x, c.y));
  });
}

TEST(LatticePatch, triangles_are_counter_clockwise_within_one_cell) {
  for_patterns([](const Pattern&, const LatticePatch& patch) {
    for (const auto& [a, b, c] : triangles_of(patch)) {
      const auto east = [&](const Corner& p) { return int(p.x) - int(a.x); };
      const auto north = [&](const Corner& p) { return int(a.y) - int(p.y); };
      EXPECT_EQ(east(b) * north(c) - east(c) * north(b), 1);
    }
  });
}

TEST(LatticePatch, edges_have_at_most_two_triangles_of_opposite_directions) {
  for_patterns([](const Pattern&, const LatticePatch& patch) {
    std::set<std::pair<Vertex, Vertex>> edges;
    std::set<std::pair<Point, Point>> lines;
    for (const auto& t : triangles_of(patch))
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_TRUE(edges.insert({vertex(t[k]), vertex(t[(k + 1) % 3])}).second);
        EXPECT_TRUE(lines.insert({point(t[k]), point(t[(k + 1) % 3])}).second);
      }
    // What is an edge of the lattice on both sides is one of the surface: both sides name the same fans.
    for (const auto& [a, b] : edges) {
      const bool is_inner = lines.contains({{b[0], b[1]}, {a[0], a[1]}});
      EXPECT_EQ(edges.contains({b, a}), is_inner);
    }
  });
}

TEST(LatticePatch, every_vertex_has_one_fan_and_fans_are_counted) {
  for_patterns([](const Pattern&, const LatticePatch& patch) {
    const auto triangles = triangles_of(patch);
    std::map<Point, std::set<std::uint32_t>> used;
    for (const auto& t : triangles)
      for (const Corner& c : t) used[point(c)].insert(c.fan);
    for (std::uint32_t y = 0; y <= Pattern::side; ++y)
      for (std::uint32_t x = 0; x <= Pattern::side; ++x) {
        const std::size_t expected = fans_at({x, y}, triangles);
        EXPECT_EQ(patch.fans(x, y), expected);
        EXPECT_LE(expected, LatticePatch::most_fans);
        // As many names as fans, so no two fans have one: edges that are inner have the same on both sides.
        const auto& names = used[Point{x, y}];
        ASSERT_EQ(names.size(), expected);
        if (expected > 0) {
          EXPECT_EQ(*names.rbegin(), expected - 1);
        }
      }
  });
}

/// Two squares side by side name the vertices on their common edge alike.
TEST(LatticePatch, neighbouring_squares_agree_about_the_fans_of_their_border) {
  for (std::uint32_t bits = 0; bits < 1u << 16; ++bits) {
    const Pattern pattern(bits);
    const LatticePatch whole(Pattern::side, Pattern::side, pattern.has_height());
    std::vector<std::array<Vertex, 3>> expected, found;
    for (const auto& t : triangles_of(whole)) expected.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
    for (const std::uint32_t first : {0u, 1u}) {  // columns 0 | 1 and 2
      const std::uint32_t width = first + 1;
      std::vector<std::uint8_t> has_height;
      for (std::uint32_t y = 0; y < Pattern::side + 3; ++y)
        for (std::uint32_t x = 0; x < width + 3; ++x)
          has_height.push_back(pattern.has_height()[y * (Pattern::side + 3) + first + x]);
      for (const auto& t : triangles_of(LatticePatch(width, Pattern::side, has_height)))
        found.push_back({Vertex{t[0].x + first, t[0].y, t[0].fan}, Vertex{t[1].x + first, t[1].y, t[1].fan},
                         Vertex{t[2].x + first, t[2].y, t[2].fan}});
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, expected) << "pattern " << std::hex << bits;
  }
}

/// A row at a pole is one place: its cells make a triangle with two postings beside it, or none.
TEST(LatticePatch, cells_at_a_pole_make_one_triangle) {
  for (std::uint32_t bits = 0; bits < 1u << 12; ++bits)
    for (const bool north : {true, false}) {
      const Pattern pattern(north ? bits << 4 | 0xF : bits | 0xF000);
      PoleRows poles;
      (north ? poles.north : poles.south) = north ? 0 : Pattern::side;
      const LatticePatch patch(Pattern::side, Pattern::side, pattern.has_height(), poles);
      const std::uint32_t pole = north ? 0 : Pattern::side, beside = north ? 1 : Pattern::side - 1;
      std::array<int, Pattern::side> at_pole{};
      auto triangles = triangles_of(patch);
      for (auto& t : triangles)
        for (Corner& c : t)
          if (c.y == pole) {
            ++at_pole[c.x];
            c.x = 0;  // one place
          }
      for (std::uint32_t x = 0; x < Pattern::side; ++x)
        ASSERT_EQ(at_pole[x], pattern.has(x, beside) && pattern.has(x + 1, beside)) << std::hex << bits;
      for (std::uint32_t y = 0; y <= Pattern::side; ++y)
        for (std::uint32_t x = 0; x <= Pattern::side && y != pole; ++x)
          ASSERT_EQ(patch.fans(x, y), fans_at({x, y}, triangles))
              << std::hex << bits << ": " << x << ", " << y;
    }
}

TEST(LatticePatch, without_voids_every_posting_is_one_vertex) {
  const std::vector<std::uint8_t> all(8 * 7, 1);
  const LatticePatch patch(5, 4, all);
  EXPECT_EQ(triangles_of(patch).size(), 40u);
  for (const auto& t : triangles_of(patch))
    for (const Corner& c : t) EXPECT_EQ(c.fan, 0u);
  EXPECT_EQ(patch.fans(0, 0), 1u);
  EXPECT_EQ(patch.fans(5, 4), 1u);
}

}  // namespace
}  // namespace cuesta
