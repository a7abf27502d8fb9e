#pragma once
/// Conditional requests.   Source: RFC 9110 §13.

#include <cstdint>
#include <string_view>

#include "apps/serve/request.h"

namespace cuesta::serve {

/// What tells one content of a file from another.
struct Validators {
  std::string_view etag;        ///< strong, with its quotes
  std::int64_t modified_s = 0;  ///< seconds since 1970
};

enum class Precondition : std::uint8_t { holds, not_modified, failed };

/// If-Match and If-Unmodified-Since, then If-None-Match and If-Modified-Since, in the order of §13.2.2; the
/// method is taken to be GET or HEAD. Dates that are not understood count as absent, tags that are not as
/// others.
Precondition check_preconditions(const Request& request, const Validators& current);

/// Whether the Range header counts: there is no If-Range, or it names the current content, strongly.
bool range_counts(const Request& request, const Validators& current);

}  // namespace cuesta::serve
