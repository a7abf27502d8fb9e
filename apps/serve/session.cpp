#include "apps/serve/session.h"

#include <algorithm>
#include <cmath>

namespace cuesta::serve {
namespace {

constexpr double burst_s = 0.25;  // of the rate that a client allows, may come at once
constexpr double least_target = 1024, most_target = 128 << 10;
constexpr double outside_factor = 4;  // what is outside of the picture may be so much coarser
constexpr double first_allowance_s = 1;

Welcome welcome_of(const Directory& d) {
  return {d.has_normals, d.has_colours, d.grid, d.lo, d.hi, d.triangles};
}

}  // namespace

Result<std::unique_ptr<Session>> Session::open(CuestaFile file, const SessionLimits& limits, Clock clock) {
  auto cut = Cut::open(std::move(file), limits.cache_bytes, clock);
  if (!cut) return fail(cut.error());
  return std::unique_ptr<Session>(new Session(std::move(*cut), limits, std::move(clock)));
}

/// An entry, with those of the page cache.
std::uint64_t Session::directory_bytes(const Directory& directory) {
  constexpr std::uint64_t entry_bytes = sizeof(PageEntry) + 40;
  std::uint64_t bytes = directory.metadata.capacity();
  for (const PageEntry& e : directory.pages) bytes += entry_bytes + e.coarser.capacity() * sizeof(PageId);
  return bytes;
}

/// A page is charged some 160 bytes for a vertex that it owns and two triangles; what mirrors them, and what
/// finds the changes of a step, take as much at most, for arrays grow by doubling. In flights it is a tenth.
std::uint64_t Session::most_bytes(const Directory& directory, const SessionLimits& limits) {
  return directory_bytes(directory) + 2 * limits.cache_bytes;
}

Session::Session(std::unique_ptr<Cut> cut, const SessionLimits& limits, Clock clock)
    : cut_(std::move(cut)),
      limits_(limits),
      clock_(std::move(clock)),
      welcome_(encode(welcome_of(cut_->directory()))),
      mirror_(cut_->directory().has_normals, cut_->directory().has_colours),
      link_(limits.step_ms) {
  cut_->cache().pool().set_vertex_uploads(false);
  budgets_.page_loads = limits.pages_per_step;
  budgets_.adapt_ms = limits.adapt_ms;
  last_step_ms_ = clock_() - limits.step_ms;
}

Result<void> Session::receive(std::span<const std::byte> message) {
  const auto decoded = decode_client_message(message);
  if (!decoded) return fail(decoded.error());
  if (const auto* hello = std::get_if<Hello>(&*decoded)) {
    set_budgets(*hello);
    settled_ = false;
    return {};
  }
  if (!hello_) return fail(ErrorCode::invalid_input, "session", "", "the first message is a hello");
  if (const auto* ack = std::get_if<Ack>(&*decoded)) {
    link_.acknowledged(ack->sequence, clock_());
  } else {
    view_ = std::get<View>(*decoded);
    settled_ = false;
  }
  return {};
}

void Session::set_budgets(const Hello& hello) {
  const bool is_first = !hello_;
  hello_ = hello;
  budgets_.triangles = std::min(hello.triangles, limits_.triangles);
  bytes_per_second_ = hello.bytes_per_second == 0
                          ? limits_.bytes_per_second
                          : std::min(hello.bytes_per_second, limits_.bytes_per_second);
  if (is_first) {
    allowance_ms_ = clock_();
    allowance_ = bytes_per_second_ * burst_s;
  }
}

/// Bytes of one message.
double Session::target_bytes() const {
  return std::clamp(std::min(link_.window_bytes() / 2, bytes_per_second_ * burst_s / 2), least_target,
                    most_target);
}

/// A power of four, and another one only when it is far off: a cut whose budgets stay the same comes to rest.
void Session::choose_upload_budget() {
  const double wanted = std::max(target_bytes() / sent_per_upload_, 16.0 * GeometryPool::dirty_bytes);
  const auto now = static_cast<double>(budgets_.upload_bytes);
  if (wanted > now / 3 && wanted < now * 3) return;
  budgets_.upload_bytes = std::uint64_t{1} << (2 * static_cast<int>(std::lround(std::log2(wanted) / 2)));
}

double Session::allowance_at(double now_ms) const {
  return std::min(allowance_ + bytes_per_second_ * (now_ms - allowance_ms_) / 1000,
                  bytes_per_second_ * burst_s);
}

void Session::fill_allowance(double now_ms) {
  allowance_ = allowance_at(now_ms);
  allowance_ms_ = now_ms;
}

double Session::wait_ms() const {
  constexpr double never = std::numeric_limits<double>::infinity();
  if (!hello_ || !view_ || settled_) return never;
  if (link_.under_way_bytes() > 0 && link_.under_way_bytes() + target_bytes() > link_.window_bytes())
    return never;
  const double now = clock_();
  const double lacking = -allowance_at(now);
  return std::max({0.0, last_step_ms_ + limits_.step_ms - now,
                   lacking > 0 ? lacking / bytes_per_second_ * 1000 + 1 : 0.0});
}

std::optional<std::string> Session::step() {
  if (wait_ms() > 0) return std::nullopt;
  const double now = clock_();
  last_step_ms_ = now;
  fill_allowance(now);
  choose_upload_budget();
  const auto scale = ErrorScale::perspective(cut_->directory().grid, *view_, outside_factor);
  const AdaptReport report = cut_->adapt(scale, static_cast<double>(hello_->tau_px), budgets_);
  settled_ = report.settled;
  auto message = mirror_.change(cut_->draw_list(), settled_, static_cast<float>(report.achieved));
  if (!message) return message;
  const auto bytes = static_cast<double>(message->size());
  if (report.upload_bytes > 0)
    sent_per_upload_ += (bytes / static_cast<double>(report.upload_bytes) - sent_per_upload_) / 4;
  sent_per_upload_ = std::clamp(sent_per_upload_, 0.002, 1.0);
  allowance_ -= bytes;
  sent_bytes_ += message->size();
  link_.sent(++sequence_, message->size(), clock_());
  return message;
}

}  // namespace cuesta::serve
