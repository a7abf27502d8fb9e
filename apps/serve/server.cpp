#include "apps/serve/server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <thread>

#include "apps/serve/worker.h"

namespace cuesta::serve {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

constexpr auto accept_pause = std::chrono::milliseconds(100);  // where the system gives no more descriptors

Result<tcp::endpoint> endpoint_of(const ServerSettings& settings) {
  error_code error;
  const auto address = boost::asio::ip::make_address(settings.bind, error);
  if (error)
    return fail(ErrorCode::invalid_input, settings.bind, "",
                "not an address such as 127.0.0.1, 0.0.0.0 or ::");
  return tcp::endpoint(address, settings.port);
}

class WorkerServer : public Server {
 public:
  WorkerServer(const ServerSettings& settings, const Site& site) : settings_(settings) {
    for (std::uint32_t i = 0; i < settings_.threads; ++i)
      workers_.push_back(std::make_unique<Worker>(settings_, site, counters_));
    for (const auto& w : workers_) counters_.push_back(&w->counters());
    acceptor_.emplace(workers_.front()->context());
    pause_.emplace(workers_.front()->context());
  }
  ~WorkerServer() override { stop(); }

  Result<void> listen(const tcp::endpoint& endpoint) {
    error_code error;
    acceptor_->open(endpoint.protocol(), error);
    if (!error) acceptor_->set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_->bind(endpoint, error);
    if (!error) acceptor_->listen(tcp::acceptor::max_listen_connections, error);
    if (!error) port_ = acceptor_->local_endpoint(error).port();
    if (error)
      return fail(ErrorCode::io, settings_.bind + ":" + std::to_string(settings_.port), "",
                  "cannot listen: " + error.message());
    boost::asio::post(workers_.front()->context(), [this] { accept(); });
    for (const auto& w : workers_) w->start();
    return {};
  }

  std::uint16_t port() const override { return port_; }

  void stop() override {
    if (stopped_) return;
    stopped_ = true;
    boost::asio::post(workers_.front()->context(), [this] {
      error_code ignored;
      acceptor_->close(ignored);
      pause_->cancel();
    });
    for (const auto& w : workers_) w->finish_connections();
    wait_for_connections();
    for (const auto& w : workers_) w->close_connections();
    for (const auto& w : workers_) w->join();
  }

 private:
  /// Connections go to threads in turn.
  void accept() {
    Worker& worker = *workers_[next_++ % workers_.size()];
    acceptor_->async_accept(worker.context(), [this, &worker](error_code error, tcp::socket socket) {
      if (!acceptor_->is_open()) return;
      if (error) return accept_later();
      boost::asio::post(worker.context(),
                        [&worker, socket = std::move(socket)]() mutable { worker.adopt(std::move(socket)); });
      accept();
    });
  }

  void accept_later() {
    pause_->expires_after(accept_pause);
    pause_->async_wait([this](error_code) {
      if (acceptor_->is_open()) accept();
    });
  }

  void wait_for_connections() {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::milliseconds(settings_.grace_ms);
    const auto open = [this] {
      std::uint64_t sum = 0;
      for (const Counters* c : counters_) sum += c->open.load(std::memory_order_relaxed);
      return sum;
    };
    while (open() > 0 && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }

  const ServerSettings settings_;
  std::vector<const Counters*> counters_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::optional<tcp::acceptor> acceptor_;
  std::optional<boost::asio::steady_timer> pause_;
  std::size_t next_ = 0;
  std::uint16_t port_ = 0;
  bool stopped_ = false;
};

}  // namespace

Result<std::unique_ptr<Server>> Server::start(const ServerSettings& settings, const Site& site) {
  const auto endpoint = endpoint_of(settings);
  if (!endpoint) return fail(endpoint.error());
  auto server = std::make_unique<WorkerServer>(settings, site);
  if (auto r = server->listen(*endpoint); !r) return fail(r.error());
  return server;
}

}  // namespace cuesta::serve
