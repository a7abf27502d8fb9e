/// Files much larger than the memory given: every format gives the same, and what is resident does not grow
/// with the file.

#include <malloc.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "ooc/corner_map.h"
#include "ooc/fingerprint.h"
#include "ooc/spilled_table.h"
#include "tests/ooc/gltf_files.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

#ifndef CUESTA_TEST_SCALE
#define CUESTA_TEST_SCALE 1
#endif
constexpr std::uint64_t mib = std::uint64_t{1} << 20;
constexpr std::uint64_t file_bytes = CUESTA_TEST_SCALE * 20 * mib;
constexpr std::uint64_t little_memory = 2 * mib;
/// A little less than what read_mesh() promises beside the memory: with it, less than any of the files.
constexpr std::uint64_t slack_bytes = 12 * mib;

std::uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t total = 0, resident = 0;
  file >> total >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// A digest of all blocks, and the most that was resident when one came.
class BlockSink : public MeshSink {
 public:
  Result<void> vertices(const VertexBlock& b) override {
    add(b.positions), add(b.normals), add(b.colours), add(b.texcoords);
    return {};
  }
  Result<void> triangles(TriangleBlock b) override {
    add(b);
    return {};
  }
  std::string digest() const { return print_.hex(); }
  std::uint64_t most_resident() const { return most_resident_; }

 private:
  template <class T>
  void add(std::span<const T> values) {
    print_.add({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
    most_resident_ = std::max(most_resident_, resident_bytes());
  }
  Fingerprint print_;
  std::uint64_t most_resident_ = 0;
};

/// A digest of the corners of all triangles: the surface, however its vertices are numbered.
class SurfaceSink : public MeshSink {
 public:
  struct Corner {
    Vec3d position;
    Vec3f normal;
    TexCoord texcoord;
  };
  Result<void> vertices(const VertexBlock& b) override {
    for (std::size_t i = 0; i < b.positions.size(); ++i) {
      vertices_.push_back({b.positions[i], b.normals.empty() ? Vec3f{} : b.normals[i],
                           b.texcoords.empty() ? TexCoord{} : b.texcoords[i]});
    }
    return {};
  }
  Result<void> triangles(TriangleBlock b) override {
    triangles_.insert(triangles_.end(), b.begin(), b.end());
    return {};
  }
  std::size_t vertex_count() const { return vertices_.size(); }
  std::string digest() const {
    std::vector<float> values;
    for (const auto& t : triangles_) {
      for (const std::uint64_t i : t) {
        const Corner& c = vertices_.at(i);
        for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(c.position[k]));
        for (int k = 0; k < 3; ++k) values.push_back(c.normal[k]);
        values.insert(values.end(), c.texcoord.begin(), c.texcoord.end());
      }
    }
    Fingerprint print;
    print.add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)});
    return print.hex();
  }

 private:
  std::vector<Corner> vertices_;
  std::vector<std::array<std::uint64_t, 3>> triangles_;
};

/// A mesh made up as it is written: a wavy strip of quads, `across` vertices wide.
struct Strip {
  static constexpr std::uint64_t across = 256;
  std::uint64_t along;  ///< vertices
  std::uint64_t vertices() const { return across * along; }
  std::uint64_t quads() const { return (across - 1) * (along - 1); }
  std::array<float, 3> position(std::uint64_t i) const {
    const std::uint64_t x = i % across, y = i / across;
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>((x * 7 + y * 13) % 32) / 4};
  }
  std::array<std::uint32_t, 4> quad(std::uint64_t q) const {
    const std::uint64_t first = q % (across - 1) + q / (across - 1) * across;
    const auto id = [](std::uint64_t i) { return static_cast<std::uint32_t>(i); };
    return {id(first), id(first + 1), id(first + across + 1), id(first + across)};
  }
  /// Every eighth is far away from quad q - 1: nothing of the one is near the other in the file.
  std::array<std::uint32_t, 4> scattered_quad(std::uint64_t q) const {
    return quad(q % 8 == 0 ? q * 1'000'003 % quads() : q);
  }
};

/// Gathers bytes and writes them in large pieces.
class Out {
 public:
  explicit Out(const std::filesystem::path& path) : file_(path, std::ios::binary) {}
  ~Out() { flush(); }
  Out(const Out&) = delete;
  Out& operator=(const Out&) = delete;
  template <class T>
  Out& raw(const T& value) {
    return text({reinterpret_cast<const char*>(&value), sizeof value});
  }
  Out& text(std::string_view text) {
    held_ += text;
    if (held_.size() > mib) flush();
    return *this;
  }
  Out& number(std::uint64_t value) { return text(std::to_string(value)).text(" "); }
  Out& position(const std::array<float, 3>& p) {  // quarters: exact in two digits
    number(static_cast<std::uint64_t>(p[0])).number(static_cast<std::uint64_t>(p[1]));
    const std::uint64_t quarters = static_cast<std::uint64_t>(p[2] * 4);
    return text(std::to_string(quarters / 4))
        .text(".")
        .text(std::to_string(quarters % 4 * 25 + 100).substr(1));
  }
  void flush() {
    EXPECT_TRUE(file_.write(held_.data(), static_cast<std::streamsize>(held_.size())));
    held_.clear();
  }

 private:
  std::ofstream file_;
  std::string held_;
};

std::string ply_header(const char* format, const Strip& strip) {
  return std::string("ply\nformat ") + format + " 1.0\nelement vertex " + std::to_string(strip.vertices()) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(strip.quads()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}
void binary_ply(const std::filesystem::path& path, bool scattered) {
  const Strip strip{file_bytes / 29 / Strip::across};
  Out out(path);
  out.text(ply_header("binary_little_endian", strip));
  for (std::uint64_t i = 0; i < strip.vertices(); ++i) out.raw(strip.position(i));
  for (std::uint64_t q = 0; q < strip.quads(); ++q)
    out.raw(std::uint8_t{4}).raw(scattered ? strip.scattered_quad(q) : strip.quad(q));
}
void text_faces(Out& out, const Strip& strip) {
  for (std::uint64_t q = 0; q < strip.quads(); ++q) {
    out.text("4 ");
    for (const std::uint32_t i : strip.quad(q)) out.number(i);
    out.text("\n");
  }
}
void text_positions(Out& out, const Strip& strip, std::string_view before = "") {
  for (std::uint64_t i = 0; i < strip.vertices(); ++i)
    out.text(before).position(strip.position(i)).text("\n");
}
void text_ply(const std::filesystem::path& path) {
  const Strip strip{file_bytes / 41 / Strip::across};
  Out out(path);
  out.text(ply_header("ascii", strip));
  text_positions(out, strip);
  text_faces(out, strip);
}
void off(const std::filesystem::path& path) {
  const Strip strip{file_bytes / 41 / Strip::across};
  Out out(path);
  out.text("OFF\n").number(strip.vertices()).number(strip.quads()).text("0\n");
  text_positions(out, strip);
  text_faces(out, strip);
}
void plain_obj(const std::filesystem::path& path) {
  const Strip strip{file_bytes / 43 / Strip::across};
  Out out(path);
  text_positions(out, strip, "v ");
  for (std::uint64_t q = 0; q < strip.quads(); ++q) {
    out.text("f ");
    for (const std::uint32_t i : strip.quad(q)) out.number(i + 1);
    out.text("\n");
  }
}
/// Every vertex has its own normal and texture coordinates; a quad before the last vertex names any of them.
void obj_with_attributes(const std::filesystem::path& path) {
  const Strip strip{file_bytes / 110 / Strip::across};
  Out out(path);
  text_positions(out, strip, "v ");
  for (std::uint64_t i = 0; i < strip.vertices(); ++i) out.text("vn 0 ").number(i % 91 + 1).text("4\n");
  for (std::uint64_t i = 0; i < strip.vertices(); ++i)
    out.text("vt ").number(i % 101).number(i % 17).text("\n");
  for (std::uint64_t q = 0; q < strip.quads(); ++q) {
    out.text("f ");
    for (const std::uint32_t i : strip.quad(q)) {
      const std::string number = std::to_string(i + 1);
      out.text(number).text("/").text(number).text("/").text(number).text(" ");
    }
    out.text("\n");
  }
}
void binary_stl(const std::filesystem::path& path) {
  const Strip strip{file_bytes / 50 / Strip::across};
  Out out(path);
  out.text(std::string(80, ' ')).raw(static_cast<std::uint32_t>(strip.quads()));
  for (std::uint64_t q = 0; q < strip.quads(); ++q) {
    const auto quad = strip.quad(q);
    out.raw(std::array<float, 3>{});
    for (std::size_t k = 0; k < 3; ++k) out.raw(strip.position(quad[k]));
    out.raw(std::uint16_t{0});
  }
}
void text_stl(const std::filesystem::path& path) {
  const Strip strip{file_bytes / 120 / Strip::across};
  Out out(path);
  out.text("solid x\n");
  for (std::uint64_t q = 0; q < strip.quads(); ++q) {
    const auto quad = strip.quad(q);
    out.text("facet normal 0 0 1\nouter loop\n");
    for (std::size_t k = 0; k < 4; ++k) out.text("vertex ").position(strip.position(quad[k])).text("\n");
    out.text("endloop\nendfacet\n");
  }
  out.text("endsolid x\n");
}
/// Positions, normals and indices one after the other in a buffer beside the document.
void gltf(const std::filesystem::path& path) {
  const Strip strip{file_bytes / 36 / Strip::across};
  const std::uint64_t n = strip.vertices(), corners = 3 * strip.quads();
  const auto number = [](std::uint64_t value) { return std::to_string(value); };
  Out(path).text(
      R"({"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":)" + number(24 * n + 4 * corners) +
      R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + number(12 * n) + R"(},{"buffer":0,"byteOffset":)" +
      number(12 * n) + R"(,"byteLength":)" + number(12 * n) + R"(},{"buffer":0,"byteOffset":)" +
      number(24 * n) + R"(,"byteLength":)" + number(4 * corners) +
      R"(}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + number(n) +
      R"(},{"bufferView":1,"componentType":5126,"type":"VEC3","count":)" + number(n) +
      R"(},{"bufferView":2,"componentType":5125,"type":"SCALAR","count":)" + number(corners) +
      R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1},"indices":2}]}],"nodes":[{"mesh":0}]})");
  Out out(path.parent_path() / "a.bin");
  for (std::uint64_t i = 0; i < n; ++i) out.raw(strip.position(i));
  for (std::uint64_t i = 0; i < n; ++i) out.raw(std::array<float, 3>{0, 0, 1});
  for (std::uint64_t q = 0; q < strip.quads(); ++q) {
    const auto quad = strip.quad(q);
    out.raw(quad[0]).raw(quad[1]).raw(quad[2]);
  }
}
void gzipped_ply(const std::filesystem::path& path) {
  const auto plain = path.parent_path() / "plain.ply";
  binary_ply(plain, false);
  gzFile out = gzopen(path.c_str(), "wb0");  // stored: as large as what is in it
  std::ifstream in(plain, std::ios::binary);
  std::string block(mib, '\0');
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0)
    EXPECT_GT(gzwrite(out, block.data(), static_cast<unsigned>(in.gcount())), 0);
  EXPECT_EQ(gzclose(out), Z_OK);
  std::filesystem::remove(plain);
}

struct Format {
  const char* name;
  std::function<void(const std::filesystem::path&)> write;
  bool same_blocks = true;  ///< also with little memory
};
void PrintTo(const Format& format, std::ostream* out) {
  *out << format.name;
}

class BoundedReading : public testing::TestWithParam<Format> {};

TEST_P(BoundedReading, LittleMemoryGivesTheSameAndStaysLittle) {
  const test::ScratchFolder folder;
  const auto path = folder / GetParam().name;
  GetParam().write(path);
  std::uint64_t size = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "")) size += entry.file_size();
  ASSERT_GT(size, file_bytes * 3 / 4);

  ::malloc_trim(0);
  const std::uint64_t before = resident_bytes();
  BlockSink little, plenty;
  const auto report = read_mesh(path, little, little_memory);
  ASSERT_TRUE(report) << report.error().text();
  EXPECT_LT(little.most_resident() - before, little_memory + slack_bytes);
  if (GetParam().same_blocks) {
    ASSERT_TRUE(read_mesh(path, plenty, test::test_memory));
    EXPECT_EQ(little.digest(), plenty.digest());
    return;
  }
  SurfaceSink little_surface, surface;
  ASSERT_TRUE(read_mesh(path, little_surface, little_memory));
  ASSERT_TRUE(read_mesh(path, surface, test::test_memory));
  EXPECT_GT(little_surface.vertex_count(), surface.vertex_count());  // or the map of corners was not full
  EXPECT_EQ(little_surface.digest(), surface.digest());
}

INSTANTIATE_TEST_SUITE_P(
    All, BoundedReading,
    testing::Values(Format{"a.ply", [](const auto& path) { binary_ply(path, false); }},
                    Format{"scattered.ply", [](const auto& path) { binary_ply(path, true); }},
                    Format{"text.ply", text_ply}, Format{"a.off", off}, Format{"plain.obj", plain_obj},
                    Format{"attributes.obj", obj_with_attributes, false}, Format{"a.stl", binary_stl},
                    Format{"text.stl", text_stl}, Format{"a.gltf", gltf}, Format{"a.ply.gz", gzipped_ply}));

ReadJob job_with(ReadBudget& budget, MeshSink& sink) {
  static const ReadProgress none;
  return {"file", {}, sink, budget, none, {}};
}

TEST(SpilledTable, KeepsWhatWasAppendedInMemoryAndInTheFile) {
  for (const std::uint64_t memory :
       {std::uint64_t{40} << 10, std::uint64_t{3} << 20, std::uint64_t{64} << 20}) {
    ReadBudget budget(memory);
    BlockSink sink;
    const ReadJob job = job_with(budget, sink);
    {
      SpilledTable<Vec3d> table(job, "numbers");
      constexpr std::uint64_t count = 200'000;
      for (std::uint64_t i = 0; i < count; ++i) {
        ASSERT_TRUE(table.append({static_cast<double>(i), 0, -1}));
        if (i % 1000 == 7) {
          ASSERT_EQ(table.get(i / 2)->x, static_cast<double>(i / 2));
        }
      }
      EXPECT_EQ(table.size(), count);
      EXPECT_EQ(table.is_spilled(), memory < (64 << 20));
      for (std::uint64_t k = 0; k < count; ++k) {
        const std::uint64_t i = k * 7919 % count;
        ASSERT_EQ(*table.get(i), (Vec3d{static_cast<double>(i), 0, -1})) << i;
      }
    }
    EXPECT_EQ(budget.left(), memory);
  }
}

TEST(SpilledTable, NeedsTwoPages) {
  ReadBudget budget(20 << 10);
  BlockSink sink;
  const ReadJob job = job_with(budget, sink);
  SpilledTable<Vec3d> table(job, "numbers");
  const auto refused = table.append({});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::out_of_budget);
}

TEST(CornerMap, MergesWhatItRemembersAndNeverMixesLargeNumbers) {
  ReadBudget budget(mib);
  CornerMap map(budget, 0);
  constexpr std::uint64_t none = ~std::uint64_t{0};
  EXPECT_TRUE(map.find_or_add({5, none, 7}, 0).is_new);
  EXPECT_FALSE(map.find_or_add({5, none, 7}, 1).is_new);
  // The same low 32 bits: other triples, and numbers of vertices that do not fit are never truncated.
  constexpr std::uint64_t large = std::uint64_t{1} << 32;
  EXPECT_TRUE(map.find_or_add({large + 5, none, 7}, 1).is_new);
  EXPECT_TRUE(map.find_or_add({6, none, 7}, large + 3).is_new);
  EXPECT_EQ(map.find_or_add({6, none, 7}, large + 4).index, large + 4);
  for (std::uint64_t i = 0; i < 1'000'000; ++i) {
    ASSERT_EQ(map.find_or_add({i, i, i}, i).index, i);
    ASSERT_FALSE(map.find_or_add({i, i, i}, i + 1).is_new);
  }
  EXPECT_TRUE(map.find_or_add({5, none, 7}, 1'000'000).is_new);  // forgotten long ago
}

TEST(MeshReader, AFileThatChangesWhileItIsReadIsToldNotTouched) {
  /// Cuts the file down to nothing at the first block: to go on reading would be SIGBUS.
  class CuttingSink : public MeshSink {
   public:
    explicit CuttingSink(std::filesystem::path path) : path_(std::move(path)) {}
    Result<void> vertices(const VertexBlock&) override {
      std::filesystem::resize_file(path_, 0);
      return {};
    }
    Result<void> triangles(TriangleBlock) override { return {}; }

   private:
    std::filesystem::path path_;
  };
  const test::ScratchFolder folder;
  const auto path = folder / "a.ply";
  binary_ply(path, false);
  CuttingSink sink(path);
  const auto report = read_mesh(path, sink, test::test_memory);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::io);
  EXPECT_NE(report.error().message.find("shorter"), std::string::npos) << report.error().text();
}

}  // namespace
}  // namespace cuesta
