#include "runtime/page_loader.h"

#include <algorithm>
#include <deque>
#include <new>
#include <string>

#ifndef __EMSCRIPTEN__
#include <condition_variable>
#include <mutex>
#include <thread>
#endif
#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace cuesta {
namespace {

Result<std::unique_ptr<ResidentPage>> read_and_replay(const CuestaFile& file, GeometryPool& pool,
                                                      const PageRequest& r) {
  SurvivorPlaces survivors(file.directory().pages[r.id]);
  for (const ResidentPage* page : r.coarser) page->place_survivors(r.id, survivors);
  if (survivors.missing())
    return fail(ErrorCode::corrupt, file.path().string(), "page " + std::to_string(r.id),
                "a surviving vertex is in none of the coarser pages");
  const auto page = file.shared_page(r.id, survivors.places());
  if (!page) return fail(page.error());
  auto resident = ResidentPage::create(r.id, **page, r.coarser, pool, r.run, r.blocks);
  if (!resident) resident.error().file = file.path().string();
  return resident;
}

}  // namespace

/// Memory that the machine refuses costs a page, not the program.
LoadedPage load_page(const CuestaFile& file, GeometryPool& pool, const PageRequest& r) {
  try {
    return {r.id, r.run, read_and_replay(file, pool, r)};
  } catch (const std::bad_alloc&) {
    return {r.id, r.run,
            fail(ErrorCode::out_of_budget, file.path().string(), "page " + std::to_string(r.id),
                 "there is no memory left to decode it")};
  }
}

namespace {

class InlineLoader : public PageLoader {
 public:
  InlineLoader(const CuestaFile& file, GeometryPool& pool) : file_(file), pool_(pool) {}
  void request(PageRequest request) override { done_.push_back(load_page(file_, pool_, request)); }
  std::optional<LoadedPage> finished() override {
    if (done_.empty()) return {};
    LoadedPage page = std::move(done_.front());
    done_.pop_front();
    return page;
  }
  void wait() override {}
  std::uint32_t width() const override { return 1; }
  bool is_inline() const override { return true; }

 private:
  const CuestaFile& file_;
  GeometryPool& pool_;
  std::deque<LoadedPage> done_;
};

#ifndef __EMSCRIPTEN__

/// A page may come a frame later; a frame may not.
void yield_to_frames() {
#ifdef __linux__
  constexpr int lower = 5;
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), lower);  // of the calling thread alone
#endif
}

class ThreadedLoader : public PageLoader {
 public:
  ThreadedLoader(const CuestaFile& file, GeometryPool& pool, std::uint32_t threads)
      : file_(file), pool_(pool) {
    for (std::uint32_t i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
  }
  ~ThreadedLoader() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    waiting_.notify_all();
    for (std::thread& t : threads_) t.join();
  }

  void request(PageRequest request) override {
    {
      const std::lock_guard lock(mutex_);
      queue_.push_back(std::move(request));
      ++under_way_;
    }
    waiting_.notify_one();
  }

  std::optional<LoadedPage> finished() override {
    const std::lock_guard lock(mutex_);
    if (done_.empty()) return {};
    LoadedPage page = std::move(done_.front());
    done_.pop_front();
    --under_way_;
    return page;
  }

  void wait() override {
    std::unique_lock lock(mutex_);
    ready_.wait(lock, [this] { return !done_.empty() || under_way_ == 0; });
  }

  // One is read while one is decoded.
  std::uint32_t width() const override { return static_cast<std::uint32_t>(threads_.size()) * 2; }

 private:
  void work() {
    yield_to_frames();
    std::unique_lock lock(mutex_);
    while (true) {
      waiting_.wait(lock, [this] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      const PageRequest request = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      LoadedPage page = load_page(file_, pool_, request);
      lock.lock();
      done_.push_back(std::move(page));
      ready_.notify_all();
    }
  }

  const CuestaFile& file_;
  GeometryPool& pool_;
  std::mutex mutex_;
  std::condition_variable waiting_, ready_;
  std::deque<PageRequest> queue_;
  std::deque<LoadedPage> done_;
  std::size_t under_way_ = 0;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

#endif

}  // namespace

MakePageLoader page_loader([[maybe_unused]] std::uint32_t threads) {
  return [=](const CuestaFile& file, GeometryPool& pool) -> std::unique_ptr<PageLoader> {
#ifndef __EMSCRIPTEN__
    if (threads > 0) return std::make_unique<ThreadedLoader>(file, pool, threads);
#endif
    return std::make_unique<InlineLoader>(file, pool);
  };
}

}  // namespace cuesta
