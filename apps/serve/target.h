#pragma once
/// What a request asks for: the path and query of its target, decoded. A path is a name to be looked up,
/// never a place in a file system.   Source: RFC 3986, RFC 9112 §3.2.

#include <optional>
#include <string>
#include <string_view>

namespace cuesta::serve {

struct Target {
  std::string path;   ///< decoded once; begins with '/', has no segment "." or "..", no NUL, no other control
                      ///< character
  std::string query;  ///< as it was sent, without '?'
};

/// @param text  origin form ("/data/x.cuesta?v=1"), or absolute form ("http://host/data/x.cuesta").
/// @return false for anything else: a bad escape, a control character, an empty or dot segment, a backslash.
/// @cost O(text), and no allocation once `target` has had room for as much.
bool parse_target(std::string_view text, Target& target);

/// Value of `key` in a query of the form "a=1&b=2", not decoded.
std::optional<std::string_view> query_value(std::string_view query, std::string_view key);

/// `text` with everything escaped that has a meaning in a path; '/' stays.
std::string escaped_path(std::string_view text);

}  // namespace cuesta::serve
