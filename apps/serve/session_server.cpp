#include "apps/serve/session_server.h"

#include <signal.h>

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <thread>

namespace cuesta::serve {
namespace {

namespace websocket = boost::beast::websocket;
using boost::asio::ip::tcp;
using boost::system::error_code;

double clock_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

struct SessionCounts {
  std::atomic<std::uint64_t> open{0}, begun{0}, refused{0}, failed{0}, sent_bytes{0}, changes{0};
};

/// Shelves of the files that have sessions.
class Shelves {
 public:
  explicit Shelves(std::uint64_t budget_bytes) : budget_bytes_(budget_bytes) {}
  std::shared_ptr<PageShelf> shelf_of(const Dataset& set) {
    const std::lock_guard lock(mutex_);
    std::erase_if(shelves_, [](const auto& entry) { return entry.second.expired(); });
    auto& known = shelves_[set.version()];
    auto shelf = known.lock();
    if (!shelf) known = shelf = std::make_shared<PageShelf>(budget_bytes_);
    return shelf;
  }

 private:
  std::uint64_t budget_bytes_;
  std::mutex mutex_;
  std::map<std::string, std::weak_ptr<PageShelf>> shelves_;
};

/// A connection and its session, on one thread.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(boost::asio::io_context& context, std::shared_ptr<const Dataset> set, tcp::socket socket,
         std::string bytes, const SessionServerSettings& settings, SessionCounts& counts)
      : settings_(settings),
        counts_(counts),
        set_(std::move(set)),
        stream_(std::move(socket)),
        timer_(context),
        handshake_(std::move(bytes)) {}
  ~Client() {
    if (session_) --counts_.open;
  }

  void start(std::shared_ptr<PageShelf> shelf) {
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = std::chrono::milliseconds(settings_.handshake_ms);
    limits.idle_timeout = std::chrono::milliseconds(settings_.silence_ms);
    limits.keep_alive_pings = true;
    stream_.set_option(limits);
    stream_.read_message_max(largest_client_message);
    stream_.binary(true);
    stream_.auto_fragment(false);
    stream_.async_accept(boost::asio::buffer(handshake_),
                         [self = shared_from_this(), shelf](error_code error) {
                           if (!error) self->open(shelf);
                         });
  }

 private:
  void open(const std::shared_ptr<PageShelf>& shelf) {
    handshake_ = {};
    if (!shelf)
      return refuse(
          {ErrorCode::out_of_budget, "session", "", "there are too many sessions; try again later"});
    auto file = CuestaFile::open(set_->file->descriptor.path());
    if (!file) return refuse(file.error());
    file->set_shelf(shelf);
    auto session = Session::open(std::move(*file), settings_.limits, clock_ms);
    if (!session) return refuse(session.error());
    session_ = std::move(*session);
    ++counts_.open;
    ++counts_.begun;
    send(session_->welcome());
    read();
  }

  void refuse(const Error& error) {
    ++counts_.refused;
    ending_ = true;
    send(encode_refusal(error));
  }

  void read() {
    stream_.async_read(buffer_,
                       [self = shared_from_this()](error_code error, std::size_t) { self->on_read(error); });
  }

  void on_read(error_code error) {
    if (error || ending_) return stop();
    const auto data = buffer_.cdata();
    const auto received = session_->receive({static_cast<const std::byte*>(data.data()), data.size()});
    buffer_.consume(buffer_.size());
    if (!received) {
      ++counts_.failed;
      ending_ = true;
      pending_ = encode_refusal(received.error());
      if (!sending_) send(std::move(pending_));
      return;
    }
    schedule();
    read();
  }

  /// The next step, when it is worth one. There is one timer, and one message on its way.
  void schedule() {
    if (sending_ || ending_) return;
    const double wait = session_->wait_ms();
    if (std::isinf(wait)) return;
    timer_.expires_after(std::chrono::microseconds(static_cast<std::int64_t>(wait * 1000)));
    timer_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->step();
    });
  }

  void step() {
    if (sending_ || ending_) return;
    auto message = session_->step();
    if (!message) return schedule();
    ++counts_.changes;
    send(std::move(*message));
  }

  void send(std::string message) {
    sending_ = true;
    out_ = std::move(message);
    counts_.sent_bytes += out_.size();
    stream_.async_write(boost::asio::buffer(out_),
                        [self = shared_from_this()](error_code error, std::size_t) {
                          self->sending_ = false;
                          if (error) return self->stop();
                          if (!self->pending_.empty()) return self->send(std::exchange(self->pending_, {}));
                          if (self->ending_) return self->close();
                          self->schedule();
                        });
  }

  void close() {
    stream_.async_close(websocket::close_code::normal,
                        [self = shared_from_this()](error_code) { self->stop(); });
  }

  void stop() {
    ending_ = true;
    timer_.cancel();
    boost::beast::get_lowest_layer(stream_).close();
  }

  const SessionServerSettings& settings_;
  SessionCounts& counts_;
  std::shared_ptr<const Dataset> set_;
  websocket::stream<boost::beast::tcp_stream> stream_;
  boost::asio::steady_timer timer_;
  std::string handshake_, out_, pending_;
  boost::beast::flat_buffer buffer_;
  std::unique_ptr<Session> session_;
  bool sending_ = false, ending_ = false;
};

/// A thread and its event loop.
struct Loop {
  boost::asio::io_context context{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{context.get_executor()};
  std::thread thread;
};

class ThreadSessions : public SessionServer {
 public:
  explicit ThreadSessions(const SessionServerSettings& settings)
      : settings_(settings), shelves_(settings.shelf_bytes) {
    for (std::uint32_t i = 0; i < settings_.threads; ++i) {
      loops_.push_back(std::make_unique<Loop>());
      loops_.back()->thread = std::thread([loop = loops_.back().get()] {
        sigset_t pipe;
        sigemptyset(&pipe);
        sigaddset(&pipe, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
        loop->context.run();
      });
    }
  }
  ~ThreadSessions() override {
    for (const auto& loop : loops_) loop->context.stop();
    for (const auto& loop : loops_) loop->thread.join();
  }

  void take(std::shared_ptr<const Dataset> set, Descriptor connection, std::string bytes) override {
    Loop& loop = *loops_[next_++ % loops_.size()];
    boost::asio::post(loop.context, [this, &loop, set = std::move(set), bytes = std::move(bytes),
                                     number = std::make_shared<Descriptor>(std::move(connection))]() mutable {
      begin(loop, std::move(set), std::move(*number), std::move(bytes));
    });
  }

  std::vector<Gauge> gauges() const override {
    const auto value = [](const std::atomic<std::uint64_t>& n) { return static_cast<double>(n.load()); };
    return {
        {"cuesta_sessions", "Sessions that are open.", value(counts_.open)},
        {"cuesta_sessions_begun_total", "Sessions that were begun.", value(counts_.begun), true},
        {"cuesta_sessions_refused_total", "Sessions that were refused.", value(counts_.refused), true},
        {"cuesta_sessions_failed_total", "Sessions ended for what a client sent.", value(counts_.failed),
         true},
        {"cuesta_session_changes_total", "Changes that were sent.", value(counts_.changes), true},
        {"cuesta_session_sent_bytes_total", "Bytes of sessions' messages.", value(counts_.sent_bytes), true}};
  }

 private:
  void begin(Loop& loop, std::shared_ptr<const Dataset> set, Descriptor connection, std::string bytes) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (::getsockname(connection.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) return;
    tcp::socket socket(loop.context);
    error_code error;
    socket.assign(address.ss_family == AF_INET6 ? tcp::v6() : tcp::v4(), connection.get(), error);
    if (error) return;
    (void)connection.release();
    auto shelf = counts_.open < settings_.sessions ? shelves_.shelf_of(*set) : nullptr;
    std::make_shared<Client>(loop.context, std::move(set), std::move(socket), std::move(bytes), settings_,
                             counts_)
        ->start(std::move(shelf));
  }

  const SessionServerSettings settings_;
  Shelves shelves_;
  SessionCounts counts_;
  std::atomic<std::size_t> next_{0};
  std::vector<std::unique_ptr<Loop>> loops_;
};

}  // namespace

std::unique_ptr<SessionServer> SessionServer::start(const SessionServerSettings& settings) {
  return std::make_unique<ThreadSessions>(settings);
}

}  // namespace cuesta::serve
