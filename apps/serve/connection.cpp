#include "apps/serve/connection.h"

#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <cstring>

namespace cuesta::serve {
namespace {

using boost::system::error_code;

constexpr std::uint64_t turn_bytes = 1
                                     << 20;  // of a large response, before other connections have their turn
constexpr int turn_responses = 32;           // to a client that sends requests faster than it takes responses
constexpr std::uint32_t drain_ms = 2'000;

}  // namespace

Connection::Connection(Worker& worker, boost::asio::ip::tcp::socket socket)
    : worker_(worker), socket_(std::move(socket)), buffer_(worker.limits().head_bytes) {
  worker_.add(*this);
}

Connection::~Connection() {
  worker_.remove(*this);
}

void Connection::start() {
  error_code error;
  socket_.non_blocking(true, error);
  if (error) return;
  set_phase(Phase::idle, worker_.limits().head_ms);
  read();
}

void Connection::set_phase(Phase phase, std::uint32_t limit_ms) {
  phase_ = phase;
  deadline_ms_ = worker_.now_ms() + limit_ms;
}

void Connection::read() {
  if (reading_) return;
  reading_ = true;
  socket_.async_read_some(
      boost::asio::buffer(buffer_.data() + filled_, buffer_.size() - filled_),
      [self = shared_from_this()](error_code error, std::size_t bytes) { self->on_read(error, bytes); });
}

void Connection::on_read(error_code error, std::size_t bytes) {
  reading_ = false;
  if (phase_ == Phase::closed) return;
  if (error) return close();
  if (phase_ == Phase::draining) return drain();
  if (phase_ == Phase::sending) return;  // a refusal: what else comes does not matter
  filled_ += bytes;
  if (phase_ == Phase::idle) set_phase(Phase::reading, worker_.limits().head_ms);
  serve_buffered();
}

/// All requests that are in the buffer, until one has to wait.
void Connection::serve_buffered() {
  for (int served = 0; phase_ != Phase::closed; ++served) {
    if (served == turn_responses)
      return boost::asio::post(worker_.context(), [self = shared_from_this()] {
        if (self->phase_ != Phase::closed) self->serve_buffered();
      });
    // Empty lines before a request are left over from the one before.
    while (filled_ >= 2 && std::memcmp(buffer_.data(), "\r\n", 2) == 0)
      std::memmove(buffer_.data(), buffer_.data() + 2, filled_ -= 2), scanned_ = 0;
    const std::size_t head_bytes = head_length({buffer_.data(), filled_}, scanned_);
    if (head_bytes == 0 && filled_ < buffer_.size()) return read();
    const bool goes_on =
        head_bytes > 0 ? serve_one(head_bytes) : refuse(431, "The head of the request is too long.");
    if (!goes_on) return;
  }
}

/// @return true if the next request can be looked at.
bool Connection::serve_one(std::size_t head_bytes) {
  started_ = std::chrono::steady_clock::now();
  head_ = head_bytes;
  Request request;
  if (const int status = parse_request({buffer_.data(), head_bytes}, request); status != 0)
    return refuse(status, "The request is not well-formed HTTP/1.1.");
  worker_.respond(request, response_);
  if (response_.upgrade) return hand_over(), false;
  if (response_.later) return answer_later(), false;
  return send();
}

bool Connection::refuse(int status, std::string_view sentence) {
  Request request;  // its connection is not kept
  request.method = Method::get;
  head_ = filled_;
  respond_refusal(response_, {request, worker_.date()}, status, sentence);
  return send();
}

void Connection::answer_later() {
  set_phase(Phase::waiting, worker_.limits().later_ms);
  self_ = shared_from_this();
  const auto ask = std::move(response_.later);
  notice_end();
  ask(weak_from_this(),
      [weak = weak_from_this(), executor = worker_.context().get_executor()](Response response) {
        boost::asio::post(executor, [weak, response = std::move(response)]() mutable {
          const auto self = weak.lock();
          if (!self || self->phase_ != Phase::waiting) return;
          self->self_.reset();
          self->response_ = std::move(response);
          if (self->send()) self->serve_buffered();
        });
      });
}

/// Closes while it waits for a response that the client no longer does. (One that has only ended what it
/// sends looks the same.)
void Connection::notice_end() {
  socket_.async_wait(boost::asio::ip::tcp::socket::wait_read, [weak = weak_from_this()](error_code error) {
    const auto self = weak.lock();
    if (!self || error || self->phase_ != Phase::waiting) return;
    char next = 0;
    const ssize_t bytes = ::recv(self->socket_.native_handle(), &next, 1, MSG_PEEK | MSG_DONTWAIT);
    if (bytes > 0 || (bytes < 0 && errno == EAGAIN)) return;  // the next request
    Counters::add(self->worker_.counters().clients_gone);
    self->close();
  });
}

void Connection::hand_over() {
  const auto take = std::move(response_.upgrade);
  std::string bytes(buffer_.data(), filled_);
  error_code error;
  phase_ = Phase::closed;
  const int number = socket_.release(error);
  if (!error) take(Descriptor(number), std::move(bytes));
}

/// Begins to send response_.   @return as on_sent(); false if it takes longer.
bool Connection::send() {
  progress_ = {};
  total_at_check_ = 0;
  response_.close = response_.close || finishing_;
  set_phase(Phase::sending, worker_.limits().stall_ms);
  return send_more();
}

bool Connection::send_more() {
  switch (send_pieces(socket_.native_handle(), response_, progress_, turn_bytes)) {
    case Sending::done:
      return on_sent();
    case Sending::socket_full:
    case Sending::turn_over:
      wait_writable();
      return false;
    case Sending::client_gone:
      Counters::add(worker_.counters().clients_gone);
      break;
    case Sending::file_failed:
      Counters::add(worker_.counters().files_failed);
      break;
  }
  Counters::add(worker_.counters().sent_bytes, progress_.total);
  close();
  return false;
}

void Connection::wait_writable() {
  socket_.async_wait(boost::asio::ip::tcp::socket::wait_write, [self = shared_from_this()](error_code error) {
    if (self->phase_ == Phase::closed) return;
    if (error) return self->close();
    if (self->send_more()) self->serve_buffered();
  });
}

/// @return true if the connection is ready for the next request.
bool Connection::on_sent() {
  Counters& counters = worker_.counters();
  Counters::add(counters.sent_bytes, progress_.total);
  Counters::add(counters.responses[static_cast<std::size_t>(response_.status / 100)]);
  counters.add_duration(std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
  response_.file.reset();
  filled_ -= head_;
  std::memmove(buffer_.data(), buffer_.data() + head_, filled_);
  head_ = scanned_ = 0;
  if (response_.close) return drain(), false;
  if (filled_ > 0)
    set_phase(Phase::reading, worker_.limits().head_ms);
  else
    set_phase(Phase::idle, worker_.limits().idle_ms);
  return true;
}

/// A client that is still sending would never see the response if the connection were closed on it.
void Connection::drain() {
  if (phase_ != Phase::draining) {
    error_code ignored;
    socket_.shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
    set_phase(Phase::draining, drain_ms);
  }
  filled_ = 0;
  read();
}

void Connection::finish() {
  finishing_ = true;
  if (phase_ == Phase::idle) close();
}

void Connection::close() {
  const auto self = std::move(self_);
  phase_ = Phase::closed;
  error_code ignored;
  socket_.close(ignored);
}

void Connection::tick(std::int64_t now_ms) {
  if (phase_ != Phase::closed && now_ms >= deadline_ms_) expire();
}

void Connection::expire() {
  if (phase_ == Phase::sending && progress_.total - total_at_check_ >= worker_.limits().stall_bytes) {
    total_at_check_ = progress_.total;
    return set_phase(Phase::sending, worker_.limits().stall_ms);
  }
  if (phase_ == Phase::idle || phase_ == Phase::draining) return close();
  Counters::add(worker_.counters().timed_out);
  if (phase_ == Phase::reading)
    refuse(408, "The request took too long.");
  else if (phase_ == Phase::waiting)
    refuse(503, "What was asked for took too long to make.");
  else
    close();
}

}  // namespace cuesta::serve
