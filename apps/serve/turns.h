#pragma once
/// Work of an event loop that must not keep it from its sockets.

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <deque>
#include <functional>
#include <utility>

namespace cuesta::serve {

/// Steps that are due, first come first served, and one for each pass of the event loop: what clients have
/// sent is read between two of them. Else a loop that is late reads one message of each client for each step
/// of it, and acknowledgements wait behind ever more views: 200 sessions on half a core had some wait 39 s.
/// Threads: that of the loop.
class Turns {
 public:
  using Step = std::function<void()>;
  explicit Turns(boost::asio::io_context& context) : context_(context) {}
  void add(Step step) {
    steps_.push_back(std::move(step));
    if (steps_.size() == 1) post_next();
  }

 private:
  void post_next() {
    boost::asio::post(context_, [this] { next(); });
  }
  void next() {
    steps_.front()();
    steps_.pop_front();
    if (!steps_.empty()) post_next();
  }
  boost::asio::io_context& context_;
  std::deque<Step> steps_;
};

}  // namespace cuesta::serve
