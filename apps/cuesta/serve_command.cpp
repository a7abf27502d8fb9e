#include "apps/cuesta/serve_command.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/serve/live_tiles.h"
#include "apps/serve/server.h"
#include "apps/serve/session_server.h"
#include "apps/serve/thumbnails.h"
#include "ooc/fingerprint.h"

namespace cuesta::app {
namespace {

constexpr auto look_every = std::chrono::milliseconds(1000);  // for files that appear, change and disappear
constexpr auto nap = std::chrono::milliseconds(50);

/// A connection takes a descriptor, and so does a file.
void raise_descriptor_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  (void)setrlimit(RLIMIT_NOFILE, &limit);
}

void tell(const std::vector<Error>& errors) {
  for (const Error& error : errors) fmt::print(stderr, "cuesta: not served: {}\n", error.text());
}

/// A path that is not there is a mistake; one that goes away later is not.
Result<void> check_paths(const ServeSettings& s) {
  std::vector<std::filesystem::path> paths = s.paths;
  if (!s.page.empty()) paths.push_back(s.page);
  for (const auto& path : paths) {
    std::error_code error;
    if (std::filesystem::exists(path, error)) continue;
    return fail(error ? ErrorCode::io : ErrorCode::not_found, path.string(), "",
                error ? error.message() : "there is no such file or folder");
  }
  return {};
}

serve::ServerSettings server_settings(const ServeSettings& s) {
  serve::ServerSettings settings;
  settings.bind = s.bind;
  settings.port = s.port;
  settings.threads = s.threads > 0 ? s.threads : std::clamp(std::thread::hardware_concurrency(), 1u, 16u);
  settings.limits.connections = s.connections;
  return settings;
}

serve::SessionServerSettings session_settings(const ServeSettings& s) {
  serve::SessionServerSettings settings;
  settings.threads = server_settings(s).threads;
  settings.sessions = s.sessions;
  settings.limits.cache_bytes = s.session_cache_bytes;
  settings.memory_bytes = s.session_memory_bytes > 0 ? s.session_memory_bytes : physical_memory_bytes() / 2;
  return settings;
}

serve::LiveTileSettings tile_settings(const ServeSettings& s) {
  serve::LiveTileSettings settings;
  settings.threads = s.tile_threads;
  settings.cache_bytes = s.tile_cache_bytes;
  settings.kept_bytes = s.tile_memory_bytes;
  return settings;
}

/// Of this program: the same for all that are built of one commit.
std::string tile_revision() {
  const std::string version = version_text();
  return fmt::format("{:08x}", checksum(std::as_bytes(std::span(version))) & 0xFFFFFFFFu);
}

serve::SiteParts site_parts(serve::Thumbnails* thumbnails, serve::SessionServer* sessions,
                            serve::LiveTiles* tiles) {
  serve::SiteParts parts;
  if (sessions)
    parts.session = [sessions](auto set, auto connection, auto bytes) {
      sessions->take(std::move(set), std::move(connection), std::move(bytes));
    };
  if (thumbnails)
    parts.thumbnail = [thumbnails](auto set, auto done) {
      thumbnails->make(std::move(set), std::move(done));
    };
  if (tiles) {
    parts.tile = [tiles](auto set, auto kind, const auto& file, auto client, auto done) {
      tiles->make(std::move(set), kind, file, std::move(client), std::move(done));
    };
    parts.tile_revision = tile_revision();
  }
  parts.gauges = [thumbnails, sessions, tiles] {
    auto gauges = sessions ? sessions->gauges() : std::vector<serve::Gauge>();
    if (tiles)
      for (const serve::Gauge& g : tiles->gauges()) gauges.push_back(g);
    gauges.push_back({"cuesta_thumbnails_drawn_total", "Pictures that were drawn.",
                      thumbnails ? static_cast<double>(thumbnails->drawn()) : 0.0, true});
    gauges.push_back({"process_resident_memory_bytes", "Memory.", static_cast<double>(resident_bytes())});
    return gauges;
  };
  return parts;
}

void follow_files(serve::Catalogue& catalogue) {
  auto next = std::chrono::steady_clock::now() + look_every;
  while (!stop_requested()) {
    std::this_thread::sleep_for(nap);
    if (std::chrono::steady_clock::now() < next) continue;
    tell(catalogue.update());
    next = std::chrono::steady_clock::now() + look_every;
  }
}

std::string address_text(const std::string& bind, std::uint16_t port) {
  return bind.find(':') == bind.npos ? fmt::format("http://{}:{}/", bind, port)
                                     : fmt::format("http://[{}]:{}/", bind, port);
}

}  // namespace

Result<void> run_serve(const ServeSettings& settings) {
  if (auto r = check_paths(settings); !r) return r;
  raise_descriptor_limit();
  serve::Catalogue catalogue(settings.paths, settings.page);
  tell(catalogue.update());
  auto thumbnails = settings.thumbnails ? serve::Thumbnails::create({}) : nullptr;
  auto sessions = settings.sessions > 0 ? serve::SessionServer::start(session_settings(settings)) : nullptr;
  auto tiles = settings.tile_threads > 0 ? serve::LiveTiles::start(tile_settings(settings)) : nullptr;
  const serve::Site site(catalogue, site_parts(thumbnails.get(), sessions.get(), tiles.get()));
  auto server = serve::Server::start(server_settings(settings), site);
  if (!server) return fail(server.error());
  fmt::print("{}: {} data sets; Ctrl-C ends it\n", address_text(settings.bind, (*server)->port()),
             catalogue.contents()->datasets.size());
  std::fflush(stdout);
  follow_files(catalogue);
  (*server)->stop();
  sessions.reset();
  tiles.reset();
  thumbnails.reset();  // while there is a server that its pictures can be given to
  return {};
}

}  // namespace cuesta::app
