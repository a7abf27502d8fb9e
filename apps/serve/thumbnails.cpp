#include "apps/serve/thumbnails.h"

#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <vector>

#include "apps/overview/sketch.h"
#include "apps/scene_show/scene_player.h"
#include "runtime/draw/png_file.h"
#include "runtime/draw/renderer.h"
#include "runtime/view_fit.h"

namespace cuesta::serve {
namespace {

constexpr double tau_px = 0.5;
constexpr Rgba8 background{255, 255, 255, 0};

/// Draws, on one thread.
class Artist {
 public:
  explicit Artist(const ThumbnailSettings& settings) : settings_(settings) {}

  Result<std::string> draw(const Dataset& set) {
    auto png = set.is_scene ? draw_scene(set) : draw_surface(set);
    if (!png) png.error().file = set.name;
    return png;
  }

 private:
  Result<std::string> draw_surface(const Dataset& set) {
    if (auto r = have_renderer(); !r) return fail(r.error());
    auto file = CuestaFile::open(set.file->descriptor.path());
    if (!file) return fail(file.error());
    const auto look = terrain_view::terrain_look(file->directory(), set.name);
    if (!look) return fail(look.error());
    auto cut = Cut::open(std::move(*file), settings_.cache_bytes, [] { return 0.0; });
    if (!cut) return fail(cut.error());
    const View view = settle(**cut, *look);
    DrawOptions options;
    options.background = background;
    options.shading = *look ? Shading::relief : Shading::lit;
    if (*look) terrain_view::set_look(**look, options);
    if (auto r = renderer_->draw((*cut)->draw_list(), view, options); !r) return fail(r.error());
    const auto picture = renderer_->read();
    return picture ? encode_png(*picture) : fail(picture.error());
  }

  /// All of it, each part as fine as the picture shows.
  Result<std::string> draw_scene(const Dataset& set) {
    scene_show::PlayerSettings settings;
    settings.scene.cache_bytes = settings_.cache_bytes;
    settings.scene.load_threads = 0;
    settings.draw.background = background;
    settings.draw.shading = Shading::lit;
    settings.draw.surface_colour = {255, 255, 255, 255};  // materials have colours
    auto player = scene_show::ScenePlayer::open(set.file->descriptor.path(), settings, [] { return 0.0; });
    if (!player) return fail(player.error());
    auto context = make_osmesa_context();
    if (!context) return fail(context.error());
    if (auto r = (*player)->draw_into(std::move(*context)); !r) return fail(r.error());
    SceneFrameOptions options;
    options.tau_px = tau_px;
    options.uniform = 1;
    const View view = empty_view();
    const View whole = fit_view((*player)->sketch(), three_quarter_direction(view.up), view);
    if (const auto frame = (*player)->settle(whole, options); !frame) return fail(frame.error());
    const auto picture = (*player)->picture();
    return picture ? encode_png(*picture) : fail(picture.error());
  }

  View empty_view() const {
    View view;
    view.width_px = settings_.width_px;
    view.height_px = settings_.height_px;
    return view;
  }

  View settle(Cut& cut, const std::optional<terrain_view::TerrainLook>& look) const {
    const View view = app::first_view(cut, look, empty_view());
    Budgets budgets;
    budgets.triangles = settings_.triangles;
    cut.settle(ErrorScale::perspective(cut.directory().grid, view), tau_px, budgets);
    return view;
  }

  Result<void> have_renderer() {
    if (renderer_) return {};
    auto context = make_osmesa_context();
    if (!context) return fail(context.error());
    auto renderer = Renderer::create(std::move(*context));
    if (!renderer) return fail(renderer.error());
    renderer_ = std::move(*renderer);
    return {};
  }

  ThumbnailSettings settings_;
  std::unique_ptr<Renderer> renderer_;
};

/// PNGs by version, the one asked for last in front.
class KeptPictures {
 public:
  explicit KeptPictures(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  const std::string* find(const std::string& version) {
    const auto at = places_.find(version);
    if (at == places_.end()) return nullptr;
    order_.splice(order_.begin(), order_, at->second);
    return &at->second->png;
  }
  void keep(const std::string& version, const std::string& png) {
    bytes_ += png.size();
    order_.push_front({version, png});
    places_[version] = order_.begin();
    while (bytes_ > most_bytes_ && order_.size() > 1) {
      bytes_ -= order_.back().png.size();
      places_.erase(order_.back().version);
      order_.pop_back();
    }
  }

 private:
  struct Kept {
    std::string version, png;
  };
  std::uint64_t most_bytes_, bytes_ = 0;
  std::list<Kept> order_;
  std::unordered_map<std::string, std::list<Kept>::iterator> places_;
};

class ThreadThumbnails : public Thumbnails {
 public:
  explicit ThreadThumbnails(const ThumbnailSettings& settings)
      : settings_(settings), kept_(settings.kept_bytes), thread_([this] { work(); }) {}
  ~ThreadThumbnails() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
    for (Order& order : orders_)
      order.done(fail(ErrorCode::cancelled, order.set->name, "", "the server stops"));
  }

  void make(std::shared_ptr<const Dataset> set, Done done) override {
    std::unique_lock lock(mutex_);
    if (const std::string* png = kept_.find(set->version())) {
      const std::string copy = *png;
      lock.unlock();
      return done(copy);
    }
    if (orders_.size() >= settings_.most_waiting) {
      lock.unlock();
      return done(fail(ErrorCode::out_of_budget, set->name, "",
                       "too many pictures are being drawn; ask again later"));
    }
    orders_.push_back({std::move(set), std::move(done)});
    lock.unlock();
    wake_.notify_one();
  }

  std::uint64_t drawn() const override { return drawn_.load(std::memory_order_relaxed); }

 private:
  struct Order {
    std::shared_ptr<const Dataset> set;
    Done done;
  };

  void work() {
    // A picture may come later; a request may not.
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
    Artist artist(settings_);
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [this] { return stop_ || !orders_.empty(); });
      if (stop_) return;
      Order order = std::move(orders_.front());
      orders_.pop_front();
      const std::string* const png = kept_.find(order.set->version());
      Result<std::string> result = png ? Result<std::string>(*png) : Result<std::string>(std::string());
      const bool is_new = png == nullptr;
      lock.unlock();
      if (is_new) result = artist.draw(*order.set);
      order.done(result);
      lock.lock();
      if (!is_new) continue;
      drawn_.fetch_add(1, std::memory_order_relaxed);
      if (result) kept_.keep(order.set->version(), *result);
    }
  }

  ThumbnailSettings settings_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Order> orders_;
  KeptPictures kept_;
  std::atomic<std::uint64_t> drawn_{0};
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Thumbnails> Thumbnails::create(const ThumbnailSettings& settings) {
  return std::make_unique<ThreadThumbnails>(settings);
}

}  // namespace cuesta::serve
