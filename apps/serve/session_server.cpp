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

#include "apps/serve/turns.h"
#include "ooc/memory_budget.h"

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
  Shelves(MemoryBudget& memory, std::uint64_t bytes) : memory_(memory), bytes_(bytes) {}
  /// @error out_of_budget: there is no memory for another one.
  Result<std::shared_ptr<PageShelf>> shelf_of(const Dataset& set) {
    const std::lock_guard lock(mutex_);
    std::erase_if(shelves_, [](const auto& entry) { return entry.second.expired(); });
    if (const auto known = shelves_.find(set.version()); known != shelves_.end())
      if (auto shelf = known->second.lock()) return shelf;
    auto room = memory_.reserve(bytes_, "a shelf of pages");
    if (!room) return fail(room.error());
    const auto kept = std::make_shared<Kept>(std::move(*room));
    std::shared_ptr<PageShelf> shelf(kept, &kept->shelf);
    shelves_[set.version()] = shelf;
    return shelf;
  }

 private:
  struct Kept {
    explicit Kept(MemoryBudget::Reservation taken) : room(std::move(taken)), shelf(room.bytes()) {}
    MemoryBudget::Reservation room;
    PageShelf shelf;
  };
  MemoryBudget& memory_;
  std::uint64_t bytes_;
  std::mutex mutex_;
  std::map<std::string, std::weak_ptr<PageShelf>> shelves_;
};

/// What all sessions share.
struct Common {
  explicit Common(const SessionServerSettings& s)
      : settings(s), memory(s.memory_bytes), shelves(memory, std::min(s.shelf_bytes, s.memory_bytes / 4)) {}
  const SessionServerSettings settings;
  SessionCounts counts;
  MemoryBudget memory;
  Shelves shelves;
};

Error refusal(ErrorCode code, std::string_view words) {
  return {code, "session", "", std::string(words)};
}

/// A connection and its session, on one thread.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(boost::asio::io_context& context, Turns& turns, std::shared_ptr<const Dataset> set,
         tcp::socket socket, std::string bytes, Common& common)
      : common_(common),
        counts_(common.counts),
        turns_(turns),
        set_(std::move(set)),
        stream_(std::move(socket)),
        timer_(context),
        handshake_(std::move(bytes)) {}
  ~Client() {
    if (is_counted_) --counts_.open;
  }

  void start() {
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = std::chrono::milliseconds(common_.settings.handshake_ms);
    limits.idle_timeout = std::chrono::milliseconds(common_.settings.silence_ms);
    limits.keep_alive_pings = true;
    stream_.set_option(limits);
    stream_.read_message_max(largest_client_message);
    stream_.binary(true);
    stream_.auto_fragment(false);
    stream_.async_accept(boost::asio::buffer(handshake_), [self = shared_from_this()](error_code error) {
      if (!error) self->begin();
    });
  }

 private:
  void begin() {
    handshake_ = {};
    if (auto opened = open(); !opened) return refuse(opened.error());
    ++counts_.begun;
    send(session_->welcome());
    read();
  }

  Result<void> open() {
    if (set_->is_scene)
      return fail(refusal(ErrorCode::invalid_input,
                          "a scene of many parts has no sessions; read its file (/data) and draw it there"));
    if (counts_.open++ >= common_.settings.sessions) {
      --counts_.open;
      return fail(refusal(ErrorCode::out_of_budget, "there are too many sessions; try again later"));
    }
    is_counted_ = true;
    auto file = CuestaFile::open(set_->file->descriptor.path());
    if (!file) return fail(file.error());
    auto shelf = common_.shelves.shelf_of(*set_);
    auto room =
        common_.memory.reserve(Session::most_bytes(file->directory(), common_.settings.limits), "a session");
    if (!shelf || !room)
      return fail(refusal(ErrorCode::out_of_budget, "the memory for sessions is taken; try again later"));
    room_ = std::move(*room);
    file->set_shelf(std::move(*shelf));
    auto session = Session::open(std::move(*file), common_.settings.limits, clock_ms);
    if (!session) return fail(session.error());
    session_ = std::move(*session);
    return {};
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

  /// The next step, when it is worth one. There is one timer, one turn, and one message on its way.
  void schedule() {
    if (sending_ || ending_ || is_due_) return;
    const double wait = session_->wait_ms();
    if (std::isinf(wait)) return;
    timer_.expires_after(std::chrono::microseconds(static_cast<std::int64_t>(wait * 1000)));
    timer_.async_wait([self = shared_from_this()](error_code error) {
      if (error || self->is_due_) return;
      self->is_due_ = true;
      self->turns_.add([self] { self->step(); });
    });
  }

  void step() {
    is_due_ = false;
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

  Common& common_;
  SessionCounts& counts_;
  Turns& turns_;
  std::shared_ptr<const Dataset> set_;
  websocket::stream<boost::beast::tcp_stream> stream_;
  boost::asio::steady_timer timer_;
  std::string handshake_, out_, pending_;
  boost::beast::flat_buffer buffer_;
  MemoryBudget::Reservation room_;
  std::unique_ptr<Session> session_;
  bool is_counted_ = false, is_due_ = false, sending_ = false, ending_ = false;
};

/// A thread and its event loop.
struct Loop {
  boost::asio::io_context context{1};
  Turns turns{context};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{context.get_executor()};
  std::thread thread;
};

class ThreadSessions : public SessionServer {
 public:
  explicit ThreadSessions(const SessionServerSettings& settings) : common_(settings) {
    for (std::uint32_t i = 0; i < settings.threads; ++i) {
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
    const SessionCounts& counts = common_.counts;
    const auto value = [](const std::atomic<std::uint64_t>& n) { return static_cast<double>(n.load()); };
    return {
        {"cuesta_sessions", "Sessions that are open.", value(counts.open)},
        {"cuesta_session_memory_bytes",
         "Memory that is set aside for sessions and the pages that they share.",
         static_cast<double>(common_.memory.used_bytes())},
        {"cuesta_sessions_begun_total", "Sessions that were begun.", value(counts.begun), true},
        {"cuesta_sessions_refused_total", "Sessions that were refused.", value(counts.refused), true},
        {"cuesta_sessions_failed_total", "Sessions ended for what a client sent.", value(counts.failed),
         true},
        {"cuesta_session_changes_total", "Changes that were sent.", value(counts.changes), true},
        {"cuesta_session_sent_bytes_total", "Bytes of sessions' messages.", value(counts.sent_bytes), true}};
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
    std::make_shared<Client>(loop.context, loop.turns, std::move(set), std::move(socket), std::move(bytes),
                             common_)
        ->start();
  }

  Common common_;
  std::atomic<std::size_t> next_{0};
  std::vector<std::unique_ptr<Loop>> loops_;
};

}  // namespace

std::unique_ptr<SessionServer> SessionServer::start(const SessionServerSettings& settings) {
  return std::make_unique<ThreadSessions>(settings);
}

}  // namespace cuesta::serve
