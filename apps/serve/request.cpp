#include "apps/serve/request.h"

#include <algorithm>
#include <boost/beast/http/basic_parser.hpp>
#include <cstring>

namespace cuesta::serve {
namespace {

namespace http = boost::beast::http;
using boost::beast::error_code;
using BeastView = boost::beast::string_view;

std::string_view view_of(BeastView text) {
  return {text.data(), text.size()};
}

Method method_of(http::verb verb) {
  switch (verb) {
    case http::verb::get:
      return Method::get;
    case http::verb::head:
      return Method::head;
    case http::verb::options:
      return Method::options;
    default:
      return Method::other;
  }
}

std::string_view* place_of(http::field name, Request& request) {
  switch (name) {
    case http::field::host:
      return &request.host;
    case http::field::range:
      return &request.range;
    case http::field::if_match:
      return &request.if_match;
    case http::field::if_none_match:
      return &request.if_none_match;
    case http::field::if_range:
      return &request.if_range;
    case http::field::if_modified_since:
      return &request.if_modified_since;
    case http::field::if_unmodified_since:
      return &request.if_unmodified_since;
    default:
      return nullptr;
  }
}

/// Beast's parser without a container of fields: what is not looked at is not stored.
class HeadParser : public http::basic_parser<true> {
 public:
  HeadParser(std::string_view head, Request& request) : head_(head), request_(request) {}

 private:
  void on_request_impl(http::verb method, BeastView, BeastView target, int version, error_code& ec) override {
    request_.method = method_of(method);
    request_.target = view_of(target);
    request_.is_http_1_0 = version == 10;
    if (version != 10 && version != 11) ec = http::error::bad_version;
  }
  void on_field_impl(http::field name, BeastView, BeastView value, error_code& ec) override {
    // A folded value is put together outside of the head.
    const auto folded = [&] {
      return !value.empty() && (value.data() < head_.data() || value.data() >= head_.data() + head_.size());
    };
    if (folded()) {
      ec = http::error::bad_obs_fold;
      return;
    }
    if (name == http::field::upgrade && boost::beast::iequals(value, "websocket"))
      request_.upgrades_to_websocket = true;
    std::string_view* const place = place_of(name, request_);
    if (place == nullptr) return;
    if (place->data() != nullptr) ec = http::error::bad_field;
    *place = value.empty() ? std::string_view("") : view_of(value);
  }
  void on_response_impl(int, BeastView, int, error_code&) override {}
  void on_header_impl(error_code&) override {}
  void on_body_init_impl(boost::optional<std::uint64_t> const&, error_code&) override {}
  std::size_t on_body_impl(BeastView body, error_code&) override { return body.size(); }
  void on_chunk_header_impl(std::uint64_t, BeastView, error_code&) override {}
  std::size_t on_chunk_body_impl(std::uint64_t, BeastView body, error_code&) override { return body.size(); }
  void on_finish_impl(error_code&) override {}

  std::string_view head_;
  Request& request_;
};

}  // namespace

std::size_t head_length(std::string_view bytes, std::size_t& scanned) {
  constexpr std::string_view end = "\r\n\r\n";
  const std::size_t from = scanned < end.size() ? 0 : scanned - (end.size() - 1);
  const std::size_t at = bytes.find(end, from);
  scanned = bytes.size();
  return at == bytes.npos ? 0 : at + end.size();
}

int parse_request(std::string_view head, Request& request) {
  request = {};
  HeadParser parser(head, request);
  parser.header_limit(static_cast<std::uint32_t>(std::min<std::size_t>(head.size(), UINT32_MAX - 1) + 1));
  parser.body_limit(UINT64_MAX);  // none would refuse every body, in Boost 1.74
  error_code ec;
  const std::size_t used = parser.put(boost::asio::const_buffer(head.data(), head.size()), ec);
  if (ec == http::error::bad_version) return 505;
  if (ec || used != head.size() || !parser.is_header_done()) return 400;
  if (!request.is_http_1_0 && request.host.data() == nullptr) return 400;
  const auto length = parser.content_length();
  request.has_body = parser.chunked() || (length && *length > 0);
  request.upgrades_to_websocket = request.upgrades_to_websocket && parser.upgrade();
  request.keep_alive = parser.keep_alive() || request.upgrades_to_websocket;
  return 0;
}

}  // namespace cuesta::serve
