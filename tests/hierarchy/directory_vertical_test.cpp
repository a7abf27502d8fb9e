/// The vertical of a field of heights in a file's directory.

#include <limits>

#include "hierarchy/directory.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

Directory directory_with(const std::optional<Vertical>& vertical) {
  TemporaryFolder folder;
  build_file(wavy_patch(12), folder / "a.cuesta");
  Directory d = CuestaFile::open(folder / "a.cuesta").value().directory();
  d.vertical = vertical;
  return d;
}

const Vertical globe{normalized(Vec3d{0.1, -0.2, 0.9}), false, {-1e6, 3e6, -6e6}, 0.0067394967};

TEST(DirectoryVertical, round_trip) {
  for (const std::optional<Vertical>& vertical : {std::optional<Vertical>{}, {Vertical{}}, {globe}}) {
    const auto decoded = decode_directory(encode_directory(directory_with(vertical)));
    ASSERT_TRUE(decoded) << decoded.error().text();
    ASSERT_EQ(decoded->vertical.has_value(), vertical.has_value());
    if (!vertical) continue;
    EXPECT_EQ(decoded->vertical->axis, vertical->axis);
    EXPECT_EQ(decoded->vertical->is_plane, vertical->is_plane);
    if (vertical->is_plane) continue;
    EXPECT_EQ(decoded->vertical->centre, vertical->centre);
    EXPECT_EQ(decoded->vertical->stretch, vertical->stretch);
  }
}

TEST(DirectoryVertical, what_is_no_vertical_is_corrupt) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto changed = [](auto change) {
    Vertical v = globe;
    change(v);
    return v;
  };
  const std::vector<Vertical> damaged{
      changed([](Vertical& v) { v.axis = {}; }),      changed([](Vertical& v) { v.axis = v.axis * 1.1; }),
      changed([&](Vertical& v) { v.axis.y = nan; }),  changed([&](Vertical& v) { v.centre.x = inf; }),
      changed([&](Vertical& v) { v.stretch = nan; }), changed([](Vertical& v) { v.stretch = -1; }),
  };
  for (std::size_t i = 0; i < damaged.size(); ++i) {
    const auto decoded = decode_directory(encode_directory(directory_with(damaged[i])));
    ASSERT_FALSE(decoded) << i;
    EXPECT_EQ(decoded.error().code, ErrorCode::corrupt) << i;
  }
}

TEST(DirectoryVertical, every_truncation_is_corrupt) {
  const std::vector<std::byte> bytes = encode_directory(directory_with(globe));
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(decode_directory(std::span(bytes).first(n))) << n << " of " << bytes.size();
}

}  // namespace
}  // namespace cuesta::test
