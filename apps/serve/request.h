#pragma once
/// A request's head, as far as this server looks at it. Requests with a body are told apart and refused.
/// Source: RFC 9112.

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace cuesta::serve {

enum class Method : std::uint8_t { get, head, options, other };

/// Views into the bytes that were parsed. Headers that are not there are empty.
struct Request {
  Method method = Method::other;
  bool is_http_1_0 = false;
  bool keep_alive = false;
  bool has_body = false;
  bool upgrades_to_websocket = false;
  std::string_view target;
  std::string_view host, range, if_match, if_none_match, if_range, if_modified_since, if_unmodified_since;
};

/// Length of the head that `bytes` begin with, its empty line included; 0 if there is no whole one yet.
/// @param scanned  bytes at the front that were looked at before and do not hold its end; is moved on.
std::size_t head_length(std::string_view bytes, std::size_t& scanned);

/// @param head  exactly a head, see head_length().
/// @return 0, or the status that refuses it: 400 for one that is not well-formed, lacks a Host, folds a
/// header over
///         lines, or repeats one of those above; 505 for HTTP versions other than 1.0 and 1.1.
/// @cost O(head), no allocation.
int parse_request(std::string_view head, Request& request);

}  // namespace cuesta::serve
