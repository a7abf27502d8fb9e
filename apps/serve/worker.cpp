#include "apps/serve/worker.h"

#include <signal.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>

#include "apps/serve/connection.h"
#include "apps/serve/http_date.h"

namespace cuesta::serve {
namespace {

void block_sigpipe() {
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
}

}  // namespace

Worker::Worker(const ServerSettings& settings, const Site& site,
               const std::vector<const Counters*>& all_counters)
    : settings_(settings),
      site_(site),
      all_counters_(all_counters),
      most_connections_(std::max(1u, settings.limits.connections / settings.threads)),
      work_(boost::asio::make_work_guard(context_)) {
  look_at_clock();
}

Worker::~Worker() {
  join();
}

void Worker::start() {
  boost::asio::post(context_, [this] { tick(); });
  thread_ = std::thread([this] {
    block_sigpipe();
    context_.run();
  });
}

void Worker::join() {
  if (thread_.joinable()) thread_.join();
}

void Worker::finish_connections() {
  boost::asio::post(context_, [this] {
    finishing_ = true;
    for (Connection* c : std::vector(connections_)) c->finish();
    timer_.cancel();
    work_.reset();
  });
}

void Worker::close_connections() {
  boost::asio::post(context_, [this] {
    for (Connection* c : std::vector(connections_)) c->close();
  });
}

void Worker::adopt(boost::asio::ip::tcp::socket socket) {
  Counters::add(counters_.accepted);
  if (finishing_ || (connections_.size() >= most_connections_ && !make_room())) {
    Counters::add(counters_.refused_connections);
    return;
  }
  boost::system::error_code ignored;
  socket.set_option(boost::asio::ip::tcp::no_delay(true), ignored);
  std::make_shared<Connection>(*this, std::move(socket))->start();
}

/// The one that has waited longest for a request goes.
bool Worker::make_room() {
  Connection* oldest = nullptr;
  for (Connection* c : connections_)
    if (c->is_idle() && (!oldest || c->deadline_ms() < oldest->deadline_ms())) oldest = c;
  if (!oldest) return false;
  Counters::add(counters_.displaced_connections);
  oldest->close();
  return true;
}

void Worker::add(Connection& connection) {
  connection.place = connections_.size();
  connections_.push_back(&connection);
  counters_.open.store(connections_.size(), std::memory_order_relaxed);
}

void Worker::remove(Connection& connection) {
  connections_.back()->place = connection.place;
  connections_[connection.place] = connections_.back();
  connections_.pop_back();
  counters_.open.store(connections_.size(), std::memory_order_relaxed);
}

void Worker::respond(const Request& request, Response& response) {
  site_.respond({request, date_}, all_counters_, scratch_, response);
}

void Worker::look_at_clock() {
  using namespace std::chrono;
  now_ms_ = duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
  const std::int64_t seconds_now = duration_cast<seconds>(system_clock::now().time_since_epoch()).count();
  if (seconds_now == date_s_) return;
  date_s_ = seconds_now;
  date_ = http_date(seconds_now);
}

void Worker::tick() {
  look_at_clock();
  for (Connection* c : std::vector(connections_)) c->tick(now_ms_);
  if (finishing_ && connections_.empty()) return;
  timer_.expires_after(std::chrono::milliseconds(settings_.limits.tick_ms));
  timer_.async_wait([this](boost::system::error_code) { tick(); });
}

}  // namespace cuesta::serve
