#include "apps/serve/live_tiles.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "apps/tiles/tile_source.h"

namespace cuesta::serve {
namespace {

using tiles::TileFile;
using tiles::TileSource;

constexpr int most_in_a_row = 8;  // of one file, while others wait longer

/// What a source is opened for: one content of one file, and what is made of it.
std::string source_name(const Dataset& set, TileKind kind) {
  return fmt::format("{}/{}/", set.version(), kind == TileKind::terrain ? "terrain" : "tiles");
}

struct Order {
  std::shared_ptr<const Dataset> set;
  TileKind kind;
  std::string source, file;

  std::string key() const { return source + file; }
};

/// Makes files, on one thread.
class Maker {
 public:
  explicit Maker(std::uint64_t cache_bytes) : cache_bytes_(cache_bytes) {}

  const std::string& open_source() const { return name_; }
  void close() {
    source_.reset();
    name_.clear();
  }

  Result<std::vector<TileFile>> make(const Order& order, std::shared_ptr<tiles::KnownTiles> known) {
    auto made = try_make(order, std::move(known));
    if (made || made.error().code == ErrorCode::not_found) return made;
    close();
    Error error = made.error();
    error.file = order.set->name;
    if (error.code == ErrorCode::out_of_budget)
      error.message = fmt::format(
          "a tile does not fit the page cache of {} bytes; the server needs a larger --tile-cache",
          cache_bytes_);
    return fail(std::move(error));
  }

 private:
  Result<std::vector<TileFile>> try_make(const Order& order, std::shared_ptr<tiles::KnownTiles> known) {
    if (name_ != order.source) {
      close();
      auto opened = open(order, std::move(known));
      if (!opened) return fail(opened.error());
      source_ = std::move(*opened);
      name_ = order.source;
    }
    return source_->make(order.file);
  }

  Result<std::unique_ptr<TileSource>> open(const Order& order,
                                           std::shared_ptr<tiles::KnownTiles> known) const {
    const std::string path = order.set->file->descriptor.path();
    if (order.kind == TileKind::terrain) {
      tiles::TerrainOptions options;
      options.cache_bytes = cache_bytes_;
      return tiles::open_terrain_source(path, options);
    }
    tiles::TileOptions options;
    options.cache_bytes = cache_bytes_;
    return tiles::open_tile_source(path, options, std::move(known));
  }

  std::uint64_t cache_bytes_;
  std::string name_;
  std::unique_ptr<TileSource> source_;
};

/// Of each data set for as long as it is served, so that no thread finds out twice what is where.
class KnownOfDatasets {
 public:
  std::shared_ptr<tiles::KnownTiles> of(const std::shared_ptr<const Dataset>& set) {
    std::erase_if(known_, [](const auto& k) { return k.second.set.expired(); });
    Known& known = known_[set->version()];
    if (!known.tiles) known = {set, std::make_shared<tiles::KnownTiles>()};
    return known.tiles;
  }

 private:
  struct Known {
    std::weak_ptr<const Dataset> set;
    std::shared_ptr<tiles::KnownTiles> tiles;
  };
  std::unordered_map<std::string, Known> known_;
};

struct TileCounts {
  std::uint64_t made = 0, from_kept = 0, shared = 0, refused = 0, let_go = 0, failed = 0;
  double seconds = 0;
};

class ThreadLiveTiles : public LiveTiles {
 public:
  explicit ThreadLiveTiles(const LiveTileSettings& settings)
      : settings_(settings), kept_(settings.kept_bytes) {
    for (std::uint32_t i = 0; i < settings_.threads; ++i) threads_.emplace_back([this] { work(); });
  }
  ~ThreadLiveTiles() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (std::thread& t : threads_) t.join();
    for (const auto& [key, waiting] : waiting_)
      for (const Waiting& w : waiting) w.done(fail(ErrorCode::cancelled, "", "", "the server stops"));
  }

  void make(std::shared_ptr<const Dataset> set, TileKind kind, const std::string& file, Client client,
            Done done) override {
    Order order{set, kind, source_name(*set, kind), file};
    std::unique_lock lock(mutex_);
    if (const auto bytes = kept_.find(order.key())) {
      ++counts_.from_kept;
      lock.unlock();
      return done(bytes);
    }
    const auto making = waiting_.find(order.key());
    if (making != waiting_.end()) {
      ++counts_.shared;
      return making->second.push_back({std::move(client), std::move(done)});
    }
    if (orders_.size() >= settings_.most_waiting) let_go();
    if (orders_.size() >= settings_.most_waiting) {
      ++counts_.refused;
      lock.unlock();
      return done(
          fail(ErrorCode::out_of_budget, set->name, "", "too many tiles are being made; ask again later"));
    }
    waiting_[order.key()].push_back({std::move(client), std::move(done)});
    orders_.push_back(std::move(order));
    lock.unlock();
    wake_.notify_one();
  }

  std::vector<Gauge> gauges() const override {
    const std::lock_guard lock(mutex_);
    const auto number = [](std::uint64_t n) { return static_cast<double>(n); };
    return {
        {"cuesta_tiles_made_total", "Tiles and tilesets that were made.", number(counts_.made), true},
        {"cuesta_tiles_kept_hits_total", "Tiles that were kept from before.", number(counts_.from_kept),
         true},
        {"cuesta_tiles_shared_total", "Requests that waited for a tile that another one had asked for.",
         number(counts_.shared), true},
        {"cuesta_tiles_refused_total", "Tiles refused for too many were waited for.", number(counts_.refused),
         true},
        {"cuesta_tiles_let_go_total", "Tiles that were not made, as all that asked had gone.",
         number(counts_.let_go), true},
        {"cuesta_tiles_failed_total", "Tiles that damage, the disk or a full cache prevented.",
         number(counts_.failed), true},
        {"cuesta_tiles_seconds_total", "Time spent on making tiles.", counts_.seconds, true},
        {"cuesta_tiles_waiting", "Tiles that are waited for.", number(waiting_.size())},
        {"cuesta_tiles_kept_bytes", "Memory of tiles that are kept.", number(kept_.bytes())},
    };
  }

 private:
  void work() {
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);  // a tile may come later than a page
    Maker maker(settings_.cache_bytes);
    int in_a_row = 0;
    std::unique_lock lock(mutex_);
    while (!stop_) {
      const auto has_work = [this] { return stop_ || !orders_.empty(); };
      if (!wake_.wait_for(lock, std::chrono::milliseconds(settings_.idle_ms), has_work)) {
        lock.unlock();
        maker.close();
        lock.lock();
        wake_.wait(lock, has_work);
      }
      if (stop_) return;
      let_go();
      if (orders_.empty()) continue;
      const Order order = take_order(maker.open_source(), in_a_row);
      if (const auto bytes = kept_.find(order.key())) {  // came with another one
        ++counts_.from_kept;
        give(lock, order, bytes);
        continue;
      }
      auto known = known_.of(order.set);
      lock.unlock();
      const auto start = std::chrono::steady_clock::now();
      auto made = maker.make(order, std::move(known));
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      lock.lock();
      counts_.seconds += took.count();
      give(lock, order, kept(order, std::move(made)));
    }
  }

  /// Orders that nobody waits for any more.
  void let_go() {
    counts_.let_go += std::erase_if(orders_, [this](const Order& order) {
      const auto waiting = waiting_.find(order.key());
      const bool gone = std::all_of(waiting->second.begin(), waiting->second.end(),
                                    [](const Waiting& w) { return w.client.expired(); });
      if (gone) waiting_.erase(waiting);
      return gone;
    });
  }

  /// The oldest of the file that the thread has open, a few times; then the oldest.
  Order take_order(const std::string& open, int& in_a_row) {
    auto at = std::find_if(orders_.begin(), orders_.end(), [&](const Order& o) { return o.source == open; });
    if (at == orders_.end() || ++in_a_row > most_in_a_row) {
      at = orders_.begin();
      in_a_row = 0;
    }
    Order order = std::move(*at);
    orders_.erase(at);
    return order;
  }

  /// The file that was ordered; all that was made is kept.
  Result<KeptTiles::Bytes> kept(const Order& order, Result<std::vector<TileFile>> made) {
    if (!made) {
      counts_.failed += made.error().code != ErrorCode::not_found;
      return fail(made.error());
    }
    KeptTiles::Bytes first;
    for (auto file = made->rbegin(); file != made->rend(); ++file) {
      ++counts_.made;
      first = std::make_shared<const std::string>(reinterpret_cast<const char*>(file->bytes.data()),
                                                  file->bytes.size());
      kept_.keep(order.source + file->name, first);
    }
    return first;
  }

  /// To all that wait for it.
  void give(std::unique_lock<std::mutex>& lock, const Order& order, const Result<KeptTiles::Bytes>& bytes) {
    const auto waiting = waiting_.extract(order.key());
    lock.unlock();
    for (const Waiting& w : waiting.mapped()) w.done(bytes);
    lock.lock();
  }

  struct Waiting {
    Client client;
    Done done;
  };

  LiveTileSettings settings_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Order> orders_;                                       // that no thread has begun
  std::unordered_map<std::string, std::vector<Waiting>> waiting_;  // by key, from order to done
  KeptTiles kept_;
  KnownOfDatasets known_;
  TileCounts counts_;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace

std::unique_ptr<LiveTiles> LiveTiles::start(const LiveTileSettings& settings) {
  return std::make_unique<ThreadLiveTiles>(settings);
}

}  // namespace cuesta::serve
