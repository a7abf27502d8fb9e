/// Chunks of values in volumes: what OpenVDB writes is read, and of a damaged one no byte goes beyond its
/// buffer.

#include <gtest/gtest.h>
#include <openvdb/Exceptions.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/DelayedLoadMetadata.h>

#include <cstring>
#include <sstream>
#include <string>
#include <vector>

namespace cuesta {
namespace {

namespace io = openvdb::io;

struct Codec {
  const char* name;
  void (*write)(std::ostream&, const std::vector<float>&);
  void (*read)(std::istream&, char*, std::size_t);
};

const Codec codecs[] = {
    {"zlib",
     [](std::ostream& out, const std::vector<float>& values) {
       io::zipToStream(out, reinterpret_cast<const char*>(values.data()), values.size() * 4);
     },
     io::unzipFromStream},
    {"Blosc",
     [](std::ostream& out, const std::vector<float>& values) {
       io::bloscToStream(out, reinterpret_cast<const char*>(values.data()), 4, values.size());
     },
     io::bloscFromStream},
};

/// The first half is all one value, so that chunks get smaller; or none, so that they do not.
std::vector<float> values(bool packs) {
  std::vector<float> out(512, 3.0f);
  std::uint32_t noise = 1;
  for (std::size_t i = packs ? 256 : 0; i < out.size(); ++i)
    out[i] = static_cast<float>(noise = noise * 1664525 + 1013904223) / 7.0f;
  return out;
}

std::string written(const Codec& codec, bool packs) {
  std::ostringstream out;
  codec.write(out, values(packs));
  return out.str();
}

std::vector<float> read(const Codec& codec, const std::string& bytes) {
  std::vector<float> out(512);
  std::istringstream in(bytes);
  codec.read(in, reinterpret_cast<char*>(out.data()), out.size() * 4);
  return out;
}

TEST(VdbDecompression, ReadsWhatIsWritten) {
  for (const Codec& codec : codecs)
    for (const bool packs : {true, false}) {
      const std::string bytes = written(codec, packs);
      EXPECT_EQ(read(codec, bytes), values(packs)) << codec.name;
      std::istringstream in(bytes);
      codec.read(in, nullptr, 2048);
      EXPECT_EQ(static_cast<std::size_t>(in.tellg()), bytes.size()) << "passed over";
    }
}

/// Under AddressSanitizer the library's own functions fail this.
TEST(VdbDecompression, SizesThatAreWrongAreRefused) {
  for (const Codec& codec : codecs)
    for (const std::int64_t size : {std::int64_t{-3000}, std::int64_t{-1}, std::int64_t{-1} << 63,
                                    std::int64_t{1} << 40, std::int64_t{3000}, std::int64_t{1}}) {
      std::string bytes = written(codec, true) + std::string(4000, 'x');
      std::memcpy(bytes.data(), &size, 8);
      EXPECT_THROW(read(codec, bytes), openvdb::RuntimeError) << codec.name << " " << size;
    }
}

TEST(VdbDecompression, DamageIsRefusedOrStaysWithinTheBuffer) {
  for (const Codec& codec : codecs) {
    const std::string good = written(codec, true);
    for (std::size_t at = 0; at < good.size(); ++at)
      for (const int bits : {0x01, 0x80, 0xff}) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ bits);
        try {
          EXPECT_EQ(read(codec, bytes).size(), 512u);
        } catch (const openvdb::RuntimeError&) {
        }
      }
  }
}

TEST(VdbDecompression, TablesThatAreTooShortAreRefused) {
  io::DelayedLoadMetadata table;
  table.resizeMask(2);
  table.resizeCompressedSize(2);
  EXPECT_EQ(table.getMask(1), 0);
  EXPECT_EQ(table.getCompressedSize(1), 0);
  EXPECT_THROW(table.getMask(2), openvdb::RuntimeError);
  EXPECT_THROW(table.getCompressedSize(2), openvdb::RuntimeError);
}

}  // namespace
}  // namespace cuesta
