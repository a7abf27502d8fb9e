/// Meshes inside gzip and Zstandard: the same surface, and every damage refused with its place.

#include <zlib.h>
#include <zstd.h>

#include <cstdlib>
#include <string>

#include "ooc/compressed_stream.h"
#include "ooc/temp_file.h"
#include "ooc/unpacked_file.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

std::string gzip(const std::string& bytes) {
  std::string out(compressBound(static_cast<uLong>(bytes.size())) + 64, '\0');
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// With a checksum, which zstd's program writes and its library does not by itself.
std::string zstd(const std::string& bytes, int window_log = 0) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
  if (window_log) {
    ZSTD_CCtx_setParameter(context, ZSTD_c_windowLog, window_log);
    ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  }
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  if (window_log) ZSTD_compressStream2(context, &to, &in, ZSTD_e_flush);  // the size is not known in advance
  EXPECT_EQ(ZSTD_compressStream2(context, &to, &in, ZSTD_e_end), 0u);
  out.resize(to.pos);
  ZSTD_freeCCtx(context);
  return out;
}

const std::string obj_head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\n";
const std::string obj = obj_head + "f 1 2 3\nf 3 2 4\n";

std::string large_obj() {
  std::string text;
  for (int i = 0; i < 60'000; ++i)
    text += "v " + std::to_string(i * 7919 % 10007) + " 1 " + std::to_string(i) + "\n";
  return text + "f 1 2 3\n";
}

Result<std::string> unpacked(const std::string& bytes, UnpackLimits limits = {}) {
  std::string out;
  auto done = unpack(bytes, compression_of(bytes), limits, [&](std::span<const char> block, std::uint64_t) {
    EXPECT_LE(block.size(), std::size_t{1} << 18);
    out.append(block.data(), block.size());
    return Result<void>{};
  });
  if (!done) return fail(done.error());
  return out;
}

TEST(CompressedMesh, AnyFormatReadsAsIfItWereNot) {
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(test::load_bytes("a.obj.gz", gzip(obj)).triangles.size(), 2u);
  EXPECT_EQ(test::load_bytes("A.OBJ.ZST", zstd(obj)).positions.size(), 4u);
  EXPECT_EQ(test::load_bytes("by_content", gzip(off)).triangles.size(), 1u);
  EXPECT_EQ(test::load_bytes("wrong.gz.off", zstd(off)).triangles.size(), 1u);
}

TEST(CompressedMesh, MembersFramesAndPaddingAreOneStream) {
  const std::string faces = obj.substr(obj_head.size());
  EXPECT_EQ(
      test::load_bytes("a.obj.gz", gzip(obj_head) + gzip(faces) + std::string(512, '\0')).triangles.size(),
      2u);
  const std::string skippable("\x50\x2a\x4d\x18\x04\0\0\0note", 12);
  EXPECT_EQ(test::load_bytes("a.obj.zst", skippable + zstd(obj_head) + zstd(faces)).triangles.size(), 2u);
  EXPECT_EQ(test::load_error("a.obj.gz", gzip(obj) + "more").code, ErrorCode::corrupt);
  EXPECT_EQ(test::load_error("a.obj.zst", zstd(obj) + "more").code, ErrorCode::corrupt);
}

TEST(CompressedMesh, CutAnywhereIsCorruptWithThePlace) {
  for (const std::string& whole : {gzip(obj), zstd(obj)})
    for (std::size_t size = 4; size < whole.size(); ++size) {
      const Error error = test::load_error("a.obj.gz", whole.substr(0, size));
      EXPECT_EQ(error.code, ErrorCode::corrupt) << size;
      EXPECT_EQ(error.place, "byte " + std::to_string(size)) << error.text();
    }
}

TEST(CompressedMesh, EveryFlippedBitIsRefusedOrHarmless) {
  for (const std::string& whole : {gzip(large_obj().substr(0, 3000)), zstd(large_obj().substr(0, 3000))})
    for (std::size_t bit = 32; bit < whole.size() * 8; bit += 3) {
      std::string damaged = whole;
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
      const auto out = unpacked(damaged);
      if (out) {
        EXPECT_EQ(*out, large_obj().substr(0, 3000)) << bit;  // a time stamp, or a flag without meaning
      } else if (out.error().code == ErrorCode::corrupt) {
        EXPECT_TRUE(out.error().place.starts_with("byte ")) << out.error().text();
      }
    }
}

TEST(CompressedMesh, ABombIsRefusedBeforeItFillsTheDisk) {
  const std::string zeros(std::size_t{4} << 20, '\0');
  UnpackLimits limits;
  limits.always_allowed_bytes = 1 << 20;
  EXPECT_TRUE(unpacked(zstd(obj), limits));
  limits.most_ratio = 100;
  const test::ScratchFolder folder;
  for (const std::string& bomb : {gzip(zeros), zstd(zeros)}) {
    const auto refused = unpacked(bomb, limits);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::out_of_budget);
    EXPECT_NE(refused.error().message.find("100 times"), std::string::npos);
    const auto file = unpack_file("bomb.gz", bomb, compression_of(bomb), folder / "", limits, {});
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().file, "bomb.gz");
  }
  EXPECT_FALSE(check_ratio(1 << 20, (std::uint64_t{1} << 40), {}));
  EXPECT_TRUE(check_ratio(1 << 20, std::uint64_t{1} << 30, {}));
  EXPECT_TRUE(check_ratio(std::uint64_t{1} << 30, std::uint64_t{1} << 39, {}));
}

TEST(CompressedMesh, AWindowBeyondTheMemoryIsRefused) {
  const std::string wide = zstd(large_obj(), 24);
  EXPECT_EQ(test::load_bytes("a.obj.zst", wide).positions.size(), 60'000u);
  const Error error = test::load_error("a.obj.zst", wide, std::uint64_t{8} << 20);
  EXPECT_EQ(error.code, ErrorCode::out_of_budget);
  EXPECT_NE(error.message.find("memory"), std::string::npos) << error.text();
}

TEST(CompressedMesh, ErrorsInsideSaySo) {
  const Error error = test::load_error("a.obj.gz", gzip(obj + "v 1 x 2\n"));
  EXPECT_EQ(error.code, ErrorCode::corrupt);
  EXPECT_EQ(error.place, "line 7 unpacked") << error.text();
  EXPECT_EQ(test::load_error("a.obj.gz", gzip("")).code, ErrorCode::corrupt);
  EXPECT_EQ(test::load_error("a.obj.gz.gz", gzip(gzip(obj))).code, ErrorCode::unsupported_version);
}

TEST(CompressedMesh, ProgressRisesOverBothPassesAndCancelsEither) {
  const test::ScratchFolder folder;
  const std::string bytes = gzip(large_obj());
  const auto path = folder.write("a.obj.gz", bytes);
  for (const double stop_at : {0.2, 0.7, 2.0}) {
    std::uint64_t last = 0;
    test::CheckingSink sink;
    const auto report =
        read_mesh(path, sink, test::test_memory, [&](std::uint64_t done, std::uint64_t total) {
          EXPECT_GE(done, last);
          EXPECT_EQ(total, bytes.size());
          last = done;
          return static_cast<double>(done) < stop_at * static_cast<double>(total);
        });
    EXPECT_EQ(report.has_value(), stop_at > 1);
    if (!report) {
      EXPECT_EQ(report.error().code, ErrorCode::cancelled);
    }
  }
}

TEST(CompressedMesh, TheTemporaryFileLeavesNoNameAndNeedsItsFolder) {
  const test::ScratchFolder folder;
  const auto path = folder.write("a.obj.zst", zstd(obj));
  const auto temp = folder / "temp";
  const auto missing = load_mesh(path, test::test_memory, nullptr, {}, temp);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
  EXPECT_NE(missing.error().message.find("--temp"), std::string::npos);
  std::filesystem::create_directory(temp);
  auto file = TempFile::create(temp);
  ASSERT_TRUE(file);
  EXPECT_TRUE(std::filesystem::is_empty(temp));
  EXPECT_TRUE(file->write(std::string("abc")));
  auto map = file->map();
  ASSERT_TRUE(map);
  EXPECT_EQ(std::string(map->bytes().data(), map->bytes().size()), "abc");
  EXPECT_EQ(file->expect(std::uint64_t{1} << 62).error().code, ErrorCode::out_of_budget);
  EXPECT_TRUE(load_mesh(path, test::test_memory, nullptr, {}, temp));
}

}  // namespace
}  // namespace cuesta
