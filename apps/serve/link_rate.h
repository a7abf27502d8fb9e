#pragma once
/// How fast a link is, from when what was sent over it was acknowledged; and how much may be under way so
/// that it is busy but nothing queues for long. Source: the model of BBR (Cardwell et al., "BBR:
/// Congestion-Based Congestion Control", ACM Queue 2016): rate is what was delivered between a message's
/// sending and its acknowledgement; what may be under way is twice rate times delay.

#include <algorithm>
#include <cstdint>
#include <deque>

namespace cuesta::serve {

class LinkRate {
 public:
  static constexpr double least_window = 4096, first_window = 16384, most_window = 4 << 20;

  /// @param step_ms  between two messages: as much more must be under way.
  explicit LinkRate(double step_ms) : step_ms_(step_ms) {}

  void sent(std::uint32_t sequence, std::uint64_t bytes, double now_ms) {
    const bool filled = under_way_ + static_cast<double>(bytes) >= window_ / 2;
    if (flying_.empty()) delivered_ms_ = now_ms;
    flying_.push_back({sequence, static_cast<double>(bytes), now_ms, delivered_, delivered_ms_, filled});
    under_way_ += static_cast<double>(bytes);
  }

  /// All up to `sequence`. One that was never sent, or was acknowledged before, counts for nothing.
  void acknowledged(std::uint32_t sequence, double now_ms) {
    if (flying_.empty() || sequence < flying_.front().sequence || sequence > flying_.back().sequence) return;
    Message last = flying_.front();
    while (!flying_.empty() && flying_.front().sequence <= sequence) {
      last = flying_.front();
      under_way_ -= last.bytes;
      delivered_ += last.bytes;
      flying_.pop_front();
    }
    const double took = std::max(now_ms - last.sent_ms, 0.1);
    delay_ms_ = delay_ms_ == 0 ? took : std::min(took, delay_ms_ + (took - delay_ms_) / 64);
    const double rate = (delivered_ - last.delivered) / std::max(now_ms - last.delivered_ms, took);
    delivered_ms_ = now_ms;
    // What was not filled says how fast the link is at least.
    if (rate > rate_)
      rate_ = rate;
    else if (last.filled)
      rate_ += (rate - rate_) / 8;
    window_ = std::clamp(2 * rate_ * (delay_ms_ + step_ms_), least_window, most_window);
  }

  double window_bytes() const { return window_; }
  double under_way_bytes() const { return under_way_; }
  double bytes_per_second() const { return rate_ * 1000; }  ///< 0: not known yet

 private:
  struct Message {
    std::uint32_t sequence;
    double bytes, sent_ms, delivered, delivered_ms;
    bool filled;  ///< the window, about
  };
  double step_ms_;
  double window_ = first_window, under_way_ = 0;
  double rate_ = 0, delay_ms_ = 0;  // bytes per ms
  double delivered_ = 0, delivered_ms_ = 0;
  std::deque<Message> flying_;
};

}  // namespace cuesta::serve
