#pragma once
/// A client that sends just the bytes it is told to.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "apps/serve/served_file.h"

namespace cuesta::test {

struct Reply {
  int status = 0;  ///< 0: the connection ended before a whole response
  std::string head, body;

  std::string header(const std::string& name) const {
    const auto at = head.find("\r\n" + name + ": ");
    if (at == head.npos) return "";
    const auto from = at + name.size() + 4;
    return head.substr(from, head.find("\r\n", from) - from);
  }
};

class RawClient {
 public:
  /// @param receive_bytes  of the socket's buffer; 0: as the system likes.
  explicit RawClient(std::uint16_t port, int receive_bytes = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_bytes > 0)
      setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  bool connected() const { return connected_; }
  int socket() const { return socket_.get(); }

  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
  }
  void get(const std::string& target, const std::string& headers = "", const std::string& method = "GET") {
    last_is_head_ = method == "HEAD";
    send(method + " " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n");
  }
  /// More bytes, at most until `wait_ms`; false at the end of the connection.
  bool receive(int wait_ms = 5000) {
    pollfd wait{socket_.get(), POLLIN, 0};
    if (::poll(&wait, 1, wait_ms) <= 0) return false;
    char buffer[16384];
    const ssize_t n = ::recv(socket_.get(), buffer, sizeof buffer, 0);
    if (n <= 0) return false;
    received_.append(buffer, static_cast<std::size_t>(n));
    return true;
  }
  Reply reply(int wait_ms = 60'000) {
    std::size_t end = 0;
    while ((end = received_.find("\r\n\r\n")) == received_.npos)
      if (!receive(wait_ms)) return {};
    Reply r;
    r.head = received_.substr(0, end + 2);
    received_.erase(0, end + 4);
    const int status = std::atoi(r.head.c_str() + 9);
    const std::size_t length = last_is_head_ || status == 101 || status == 204 || status == 304
                                   ? 0
                                   : std::strtoull(r.header("Content-Length").c_str(), nullptr, 10);
    while (received_.size() < length)
      if (!receive(wait_ms)) return r;
    r.status = status;
    r.body = received_.substr(0, length);
    received_.erase(0, length);
    return r;
  }
  Reply ask(const std::string& target, const std::string& headers = "", const std::string& method = "GET") {
    get(target, headers, method);
    return reply();
  }
  /// Just so many bytes.
  std::optional<std::string> take(std::size_t count, int wait_ms) {
    while (received_.size() < count)
      if (!receive(wait_ms)) return std::nullopt;
    std::string bytes = received_.substr(0, count);
    received_.erase(0, count);
    return bytes;
  }
  /// True if the server closes within the time, whatever it sends before.
  bool is_closed(int wait_ms) {
    while (receive(wait_ms)) {
    }
    char byte;
    return ::recv(socket_.get(), &byte, 1, MSG_DONTWAIT) == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
  }
  std::size_t buffered() const { return received_.size(); }

 private:
  serve::Descriptor socket_;
  bool connected_ = false, last_is_head_ = false;
  std::string received_;
};

}  // namespace cuesta::test
