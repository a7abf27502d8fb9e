#pragma once
/// Dates of HTTP headers, whole seconds UTC.   Source: RFC 9110 §5.6.7.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cuesta::serve {

/// "Sun, 06 Nov 1994 08:49:37 GMT".   @param unix_s  seconds since 1970, in the years 1 to 9999.
std::string http_date(std::int64_t unix_s);

/// Any of the three forms that a recipient must accept: the above, RFC 850's ("Sunday, 06-Nov-94 08:49:37
/// GMT", its year the one within 50 years of 2026) and asctime's ("Sun Nov  6 08:49:37 1994"). Day names are
/// not checked against dates. Nothing for anything else.
std::optional<std::int64_t> parse_http_date(std::string_view text);

}  // namespace cuesta::serve
