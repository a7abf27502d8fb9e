#pragma once
/// A server in the test's own process, over a folder of two files: sphere.cuesta, and large.cuesta, which is
/// more than the system's socket buffers take.

#include <memory>
#include <random>

#include "apps/serve/server.h"
#include "tests/apps/serve/raw_client.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {

inline constexpr std::size_t large_bytes = 24u << 20;

/// A .cuesta file without pages that anybody reads: a header, a directory, and a block of noise before it.
inline void write_large_file(const std::filesystem::path& path, std::uint32_t seed) {
  const auto small = path.string() + ".small";
  build_file(bumpy_sphere(6), small);
  const auto from = CuestaFile::open(small);
  ASSERT_TRUE(from);
  auto to = ContainerWriter::create(path);
  ASSERT_TRUE(to);
  Directory directory = from->directory();
  const auto reader = ContainerReader::open(small, ContainerKind::surface);
  for (PageEntry& e : directory.pages) {
    const auto block = to->append(*reader->read(e.block));
    ASSERT_TRUE(block);
    e.block = *block;
  }
  std::mt19937 random(seed);
  std::vector<std::byte> noise(large_bytes);
  for (std::size_t i = 0; i < noise.size(); i += 64) noise[i] = static_cast<std::byte>(random());
  directory.metadata = "{\"seed\":" + std::to_string(seed) + "}";
  ASSERT_TRUE(to->append(noise));
  ASSERT_TRUE(to->finish(encode_directory(directory)));
  std::filesystem::remove(small);
}

class ServedFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder / "served");
    build_file(bumpy_sphere(12), folder / "served/sphere.cuesta");
    write_large_file(folder / "served/large.cuesta", 1);
  }
  void TearDown() override {
    if (server) server->stop();
  }
  void start(serve::ServerSettings settings = {}, serve::SiteParts parts = {}) {
    settings.port = 0;
    settings.grace_ms = 3000;
    settings.limits.tick_ms = 20;
    catalogue = std::make_unique<serve::Catalogue>(std::vector<std::filesystem::path>{folder / "served"},
                                                   std::filesystem::path());
    catalogue->update();
    site = std::make_unique<serve::Site>(*catalogue, std::move(parts));
    auto started = serve::Server::start(settings, *site);
    ASSERT_TRUE(started) << started.error().text();
    server = std::move(*started);
  }
  RawClient client(int receive_bytes = 0) const { return RawClient(server->port(), receive_bytes); }
  /// Another client is served as if nothing had happened.
  void expect_alive() const {
    RawClient other(server->port());
    EXPECT_EQ(other.ask("/healthz").body, "ok\n");
    EXPECT_EQ(other.ask("/data/sphere.cuesta", "Range: bytes=0-5\r\n").body, "CUESTA");
  }
  /// A number of /metrics.
  double metric(const std::string& name) const {
    RawClient other(server->port());
    const std::string text = other.ask("/metrics").body;
    const auto at = text.find("\n" + name + " ");
    return at == text.npos ? -1 : std::strtod(text.c_str() + at + name.size() + 2, nullptr);
  }
  TemporaryFolder folder;
  std::unique_ptr<serve::Catalogue> catalogue;
  std::unique_ptr<serve::Site> site;
  std::unique_ptr<serve::Server> server;
};

}  // namespace cuesta::test
