/// Files of shipped versions still open, and give the cuts they gave.

#include <gtest/gtest.h>
#include <xxhash.h>

#include "hierarchy/verify_file.h"
#include "tests/runtime/open_file.h"

namespace cuesta::test {
namespace {

const std::filesystem::path version_1 =
    std::filesystem::path(CUESTA_SOURCE_DIR) / "tests/data/torus_v1.cuesta";

/// Independent of the order of triangles and of where vertices lie in memory.
std::uint64_t fingerprint(Cut& cut) {
  const DrawList list = cut.draw_list();
  std::uint64_t sum = 0;
  for (const Range& r : list.draws)
    for (std::uint32_t i = r.first; i < r.first + r.count; i += 3) {
      std::array<Vec3i, 3> t;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const DrawVertex& v = list.vertices[list.indices[i + k]];
        t[k] = {v.x, v.y, v.z};
      }
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      sum += XXH3_64bits(t.data(), sizeof t);
    }
  return sum;
}

TEST(Format, version_1_opens_and_is_right) {
  const auto file = CuestaFile::open(version_1);
  ASSERT_TRUE(file) << file.error().text();
  const Directory& d = file->directory();
  EXPECT_EQ(d.vertices, 512u);
  EXPECT_EQ(d.triangles, 1024u);
  EXPECT_EQ(d.pages.size(), 5u);
  EXPECT_TRUE(d.has_normals && d.has_colours && !d.has_texcoords);
  EXPECT_EQ(d.metadata, "{\"made for\":\"tests of format version 1\"}");
  const auto report = verify_file(*file);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->ok());
}

TEST(Format, version_1_gives_the_same_cuts) {
  struct Expected {
    double tau;
    std::uint64_t triangles, fingerprint;
  };
  const auto cut = open_cut(version_1);
  ASSERT_TRUE(cut);
  for (const Expected& e :
       {Expected{-1, 1024, 0xc4b64e99a1d72cacull}, Expected{0.01, 688, 0xba303231fede5169ull},
        Expected{0.05, 250, 0x420c45ef980b3a57ull}}) {
    const auto report = cut->settle(ErrorScale::uniform(cut->directory().grid), e.tau, {});
    EXPECT_EQ(report.triangles, e.triangles) << "tau " << e.tau;
    EXPECT_EQ(fingerprint(*cut), e.fingerprint) << std::hex << "0x" << fingerprint(*cut);
  }
}

}  // namespace
}  // namespace cuesta::test
