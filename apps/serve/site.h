#pragma once
/// What is behind each address: a request in, a response out. Knows no sockets.
///
///   /                          start page
///   /api/datasets              JSON: what is served
///   /api/datasets/NAME         JSON: all that is known of it
///   /data/NAME.cuesta          the file, in ranges; with ?v=VERSION a client need never ask again
///   /tiles/NAME/…              the files of an export as 3D Tiles, made here; with ?v=VERSION, too
///   /terrain/NAME/…            … as quantized-mesh
///   /thumbnail/NAME.png        a picture of it, rendered here
///   /view/…                    the files of the web page, if there is one
///   /session/NAME              WebSocket: a view-dependent session
///   /healthz, /metrics

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/serve/byte_range.h"
#include "apps/serve/catalogue.h"
#include "apps/serve/kept_tiles.h"
#include "apps/serve/metrics.h"
#include "apps/serve/response.h"
#include "apps/serve/target.h"
#include "apps/serve/tile_address.h"

namespace cuesta::serve {

/// What the site asks others for. Each may be empty: then there is no such thing.
struct SiteParts {
  /// PNG of a data set, given to the function when it is there, from any thread; or why there is none.
  std::function<void(std::shared_ptr<const Dataset>, std::function<void(Result<std::string>)>)> thumbnail;
  /// Takes a connection over, with the bytes that were read from it.
  std::function<void(std::shared_ptr<const Dataset>, Descriptor, std::string)> session;
  /// A file of an export, given to the function when it is there, from any thread; or why there is none.
  std::function<void(std::shared_ptr<const Dataset>, TileKind, const std::string& file, Client,
                     std::function<void(const Result<KeptTiles::Bytes>&)>)>
      tile;
  /// Of what makes tiles, to be in their ETags: another program may make others of the same file.
  std::string tile_revision;
  std::function<std::vector<Gauge>()> gauges;
};

class Site {
 public:
  Site(Catalogue& catalogue, SiteParts parts) : catalogue_(catalogue), parts_(std::move(parts)) {}

  /// What a thread keeps between requests.
  struct Scratch {
    std::shared_ptr<const Contents> contents;
    std::uint64_t generation = 0;
    Target target;
    std::vector<ByteRange> ranges;
  };
  /// @param counters  of all threads, for /metrics.
  /// Threads: any, each with its own scratch and response.
  void respond(const ResponseFrame& frame, const std::vector<const Counters*>& counters, Scratch& scratch,
               Response& response) const;

 private:
  struct Exchange;
  void route(Exchange& x) const;
  static std::optional<std::string_view> caching(Exchange& x, const Dataset& set);
  void data(Exchange& x, std::string_view name) const;
  void dataset_json(Exchange& x, std::string_view name) const;
  void thumbnail(Exchange& x, std::string_view name) const;
  void tile(Exchange& x, const TileAddress& address) const;
  void session(Exchange& x, std::string_view name) const;
  void page_file(Exchange& x, std::string_view name) const;
  void metrics(Exchange& x) const;

  Catalogue& catalogue_;
  SiteParts parts_;
};

}  // namespace cuesta::serve
