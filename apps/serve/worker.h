#pragma once
/// A thread of the server and its connections.

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/serve/metrics.h"
#include "apps/serve/server.h"

namespace cuesta::serve {

class Connection;

class Worker {
 public:
  Worker(const ServerSettings& settings, const Site& site, const std::vector<const Counters*>& all_counters);
  ~Worker();

  void start();
  /// On any thread: posts to the worker's own.
  void finish_connections();
  void close_connections();
  void join();

  /// On the worker's thread.
  void adopt(boost::asio::ip::tcp::socket socket);
  void add(Connection& connection);
  void remove(Connection& connection);
  void respond(const Request& request, Response& response);

  boost::asio::io_context& context() { return context_; }
  const ClientLimits& limits() const { return settings_.limits; }
  Counters& counters() { return counters_; }
  std::int64_t now_ms() const { return now_ms_; }  ///< of the last tick
  const std::string& date() const { return date_; }

 private:
  void tick();
  void look_at_clock();
  bool make_room();

  const ServerSettings& settings_;
  const Site& site_;
  const std::vector<const Counters*>& all_counters_;
  std::size_t most_connections_;
  Counters counters_;
  Site::Scratch scratch_;
  std::vector<Connection*> connections_;  // of handlers that the context owns
  boost::asio::io_context context_{1};
  std::optional<boost::asio::executor_work_guard<boost::asio::io_context::executor_type>> work_;
  boost::asio::steady_timer timer_{context_};
  bool finishing_ = false;
  std::int64_t now_ms_ = 0, date_s_ = 0;
  std::string date_;
  std::thread thread_;
};

}  // namespace cuesta::serve
