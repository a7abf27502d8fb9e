#include "runtime/part_store.h"

#include <algorithm>
#include <deque>
#include <new>
#include <optional>
#include <string>
#include <utility>

#ifndef __EMSCRIPTEN__
#include <condition_variable>
#include <mutex>
#include <thread>
#endif

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint32_t most_asked = 64;

}  // namespace

struct PartStore::Job {
  std::uint32_t part, have_segments, segments;
  std::shared_ptr<const Tom> have;
};

struct PartStore::Done {
  std::uint32_t part, segments;
  Result<std::shared_ptr<const Tom>> tom;
};

/// Threads that run jobs; without any, the caller does.
class PartStore::Loader {
 public:
  Loader(PrefixReader reader, std::uint32_t threads, PrefixAtHand at_hand)
      : reader_(std::move(reader)), at_hand_(std::move(at_hand)) {
#ifndef __EMSCRIPTEN__
    for (std::uint32_t i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
#else
    (void)threads;
#endif
  }
#ifdef __EMSCRIPTEN__
  void add(Job job) {
    run_or_keep(std::move(job));
  }
  std::optional<Done> next() {
    run_kept();
    return take();
  }
  void wait() {}
#else
  ~Loader() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    waiting_.notify_all();
    for (std::thread& t : threads_) t.join();
  }
  void add(Job job) {
    if (threads_.empty()) return run_or_keep(std::move(job));
    {
      const std::lock_guard lock(mutex_);
      queue_.push_back(std::move(job));
    }
    waiting_.notify_one();
  }
  std::optional<Done> next() {
    const std::lock_guard lock(mutex_);
    run_kept();
    return take();
  }
  void wait() {
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [this] { return queue_.empty() && running_ == 0; });
  }
#endif

 private:
  void run_or_keep(Job job) {
    if (at_hand_ && !at_hand_(job.part, job.have_segments, job.segments))
      kept_.push_back(std::move(job));
    else
      done_.push_back(run(job));
  }
  void run_kept() {
    for (Job& job : std::exchange(kept_, {})) run_or_keep(std::move(job));
  }

  std::optional<Done> take() {
    if (done_.empty()) return {};
    Done done = std::move(done_.front());
    done_.pop_front();
    return done;
  }

  /// Memory that the machine refuses costs a segment, not the program.
  Done run(const Job& job) const {
    try {
      auto tom = reader_(job.part, job.have.get(), job.have_segments, job.segments);
      if (!tom) return {job.part, job.segments, fail(tom.error())};
      return {job.part, job.segments, std::make_shared<const Tom>(std::move(*tom))};
    } catch (const std::bad_alloc&) {
      return {job.part, job.segments,
              fail(ErrorCode::out_of_budget, "", "part " + std::to_string(job.part),
                   "there is no memory left to decode it")};
    }
  }

#ifndef __EMSCRIPTEN__
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      waiting_.wait(lock, [this] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      const Job job = std::move(queue_.front());
      queue_.pop_front();
      ++running_;
      lock.unlock();
      Done done = run(job);
      lock.lock();
      done_.push_back(std::move(done));
      --running_;
      idle_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable waiting_, idle_;
  std::deque<Job> queue_;
  std::uint32_t running_ = 0;
  bool stop_ = false;
  std::vector<std::thread> threads_;
#endif
  PrefixReader reader_;
  PrefixAtHand at_hand_;
  std::vector<Job> kept_;  // for what is not at hand
  std::deque<Done> done_;
};

PartStore::PartStore(std::span<const ScenePartEntry> parts, PrefixReader reader, std::uint64_t bytes,
                     std::uint32_t threads, PrefixAtHand at_hand)
    : entries_(parts),
      limit_(bytes),
      // As many as a frame may take to come round; of what is asked for, few enough to follow a camera.
      width_(at_hand        ? most_asked
             : threads == 0 ? 1'000'000
                            : 32 * threads),
      parts_(parts.size()),
      loader_(std::make_unique<Loader>(std::move(reader), threads, std::move(at_hand))) {}

PartStore::~PartStore() = default;

void PartStore::want(std::uint32_t part, double triangles, double priority) {
  Part& p = parts_[part];
  const std::vector<TomSegment>& segments = entries_[part].segments;
  CUESTA_CHECK(!segments.empty(), part);
  std::uint32_t wanted = 1;
  while (wanted < segments.size() && double(segments[wanted - 1].triangles) < triangles) ++wanted;
  const bool first = !wanted_now(p);
  p.wanted = first ? wanted : std::max(p.wanted, wanted);
  p.priority = first ? priority : std::max(p.priority, priority);
  p.wanted_frame = frame_;
}

/// What tom.h says that the arrays take, and the error steps at their most.
std::uint64_t PartStore::bytes_of(std::uint32_t part, std::uint32_t segments) const {
  if (segments == 0) return 0;
  const TomSegment& s = entries_[part].segments[segments - 1];
  const AttributeSet& a = entries_[part].attributes;
  const std::uint64_t vertex = 16u + (a.normals ? 12u : 0u) + (a.colours ? 4u : 0u) + (a.texcoords ? 8u : 0u);
  return vertex * s.vertices + sizeof(Triangle) * s.triangles + 1600;
}

void PartStore::take_in(Done done, StoreReport& report) {
  Part& p = parts_[done.part];
  reserved_ -= p.reserved;
  --under_way_;
  if (done.tom) {
    if (p.segments > 1) bytes_ -= size_bytes(*p.tom);
    p.tom = std::move(*done.tom);
    p.segments = done.segments;
    bytes_ += size_bytes(*p.tom);
    if (p.segments == 1) p.base = p.tom;
    ++report.loaded;
  } else {
    p.broken = true;
    errors_.push_back(done.tom.error());
  }
  p.reserved = 0;
}

void PartStore::take_in(StoreReport& report) {
  while (auto done = loader_->next()) take_in(std::move(*done), report);
}

/// Down to the first segment, and a part that has only that, to nothing.   @return the bytes that came free
std::uint64_t PartStore::evict(Part& p) {
  const std::uint64_t freed = size_bytes(*p.tom);
  if (p.segments == 1) p.base.reset();
  p.tom = p.base;
  p.segments = p.base ? 1 : 0;
  bytes_ -= freed;
  return freed;
}

bool PartStore::make_room(std::uint64_t bytes, const Part& needing, StoreReport& report) {
  if (bytes_ + reserved_ + bytes <= limit_) return true;
  victims_.clear();
  for (std::uint32_t i = 0; i < parts_.size(); ++i) {
    const Part& p = parts_[i];
    const bool may_go = wanted_now(p) ? p.segments > 1 && p.priority < needing.priority / 2 : p.segments > 0;
    if (may_go && p.reserved == 0 && &p != &needing) victims_.push_back(i);
  }
  std::sort(victims_.begin(), victims_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Part &p = parts_[a], &q = parts_[b];
    return p.wanted_frame != q.wanted_frame ? p.wanted_frame < q.wanted_frame : p.priority < q.priority;
  });
  for (const std::uint32_t v : victims_) {
    while (parts_[v].segments > 0 && (!wanted_now(parts_[v]) || parts_[v].segments > 1) &&
           bytes_ + reserved_ + bytes > limit_) {
      evict(parts_[v]);
      ++report.evicted;
    }
    if (bytes_ + reserved_ + bytes <= limit_) return true;
  }
  return false;
}

void PartStore::request(std::uint32_t part) {
  Part& p = parts_[part];
  p.reserved = bytes_of(part, p.segments + 1);
  reserved_ += p.reserved;
  ++under_way_;
  loader_->add({part, p.segments, p.segments + 1, p.tom});
}

StoreReport PartStore::update() {
  StoreReport report;
  take_in(report);
  missing_.clear();
  for (std::uint32_t i = 0; i < parts_.size(); ++i)
    if (wanted_now(parts_[i]) && !parts_[i].broken && parts_[i].segments < parts_[i].wanted) {
      ++report.missing;
      if (parts_[i].reserved == 0) missing_.push_back(i);
    }
  std::sort(missing_.begin(), missing_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Part &p = parts_[a], &q = parts_[b];
    const bool base_p = p.segments == 0, base_q = q.segments == 0;
    return base_p != base_q ? base_p : p.priority != q.priority ? p.priority > q.priority : a < b;
  });
  for (const std::uint32_t part : missing_) {
    if (under_way_ >= width_) break;
    if (make_room(bytes_of(part, parts_[part].segments + 1), parts_[part], report))
      request(part);
    else
      ++report.waiting_for_budget;
  }
  report.resident_bytes = bytes_;
  ++frame_;
  return report;
}

void PartStore::wait() {
  loader_->wait();
}

}  // namespace cuesta
