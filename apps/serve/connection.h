#pragma once
/// One client: reads requests, sends responses, in turns. All of it on its worker's thread.

#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <memory>
#include <vector>

#include "apps/serve/response.h"
#include "apps/serve/send_pieces.h"
#include "apps/serve/worker.h"

namespace cuesta::serve {

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Worker& worker, boost::asio::ip::tcp::socket socket);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start();
  /// Its time may be over.
  void tick(std::int64_t now_ms);
  /// Waits for a request of which nothing has come.
  bool is_idle() const { return phase_ == Phase::idle; }
  std::int64_t deadline_ms() const { return deadline_ms_; }
  /// After the response under way; at once if there is none.
  void finish();
  void close();

  std::size_t place = 0;  ///< of the worker

 private:
  enum class Phase : std::uint8_t { idle, reading, waiting, sending, draining, closed };
  using Time = std::chrono::steady_clock::time_point;

  void set_phase(Phase phase, std::uint32_t limit_ms);
  void read();
  void on_read(boost::system::error_code error, std::size_t bytes);
  void serve_buffered();
  bool serve_one(std::size_t head_bytes);
  bool refuse(int status, std::string_view sentence);
  void answer_later();
  void notice_end();
  void hand_over();
  bool send();
  bool send_more();
  bool on_sent();
  void wait_writable();
  void drain();
  void expire();

  Worker& worker_;
  boost::asio::ip::tcp::socket socket_;
  Phase phase_ = Phase::idle;
  std::int64_t deadline_ms_ = 0;
  bool finishing_ = false, reading_ = false;
  std::shared_ptr<Connection> self_;  // while it waits for a response, and nothing else keeps it
  std::vector<char> buffer_;
  std::size_t filled_ = 0, head_ = 0,
              scanned_ = 0;  // bytes in the buffer; of the request under way; looked at
  Response response_;
  SendProgress progress_;
  std::uint64_t total_at_check_ = 0;
  Time started_;
};

}  // namespace cuesta::serve
