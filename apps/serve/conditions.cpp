#include "apps/serve/conditions.h"

#include <algorithm>

#include "apps/serve/http_date.h"

namespace cuesta::serve {
namespace {

/// True if `list` is "*" or has the tag. Weak tags of the list count only where `weakly`.
bool lists(std::string_view list, std::string_view etag, bool weakly) {
  if (list == "*") return true;
  while (!list.empty()) {
    const auto start = list.find_first_not_of(" \t,");
    if (start == list.npos) return false;
    list.remove_prefix(start);
    const bool weak = list.starts_with("W/");
    if (weak) list.remove_prefix(2);
    if (!list.starts_with('"')) return false;
    const auto end = list.find('"', 1);
    if (end == list.npos) return false;
    if ((weakly || !weak) && list.substr(0, end + 1) == etag) return true;
    list.remove_prefix(end + 1);
  }
  return false;
}

bool given(std::string_view header) {
  return header.data() != nullptr;
}

}  // namespace

Precondition check_preconditions(const Request& request, const Validators& current) {
  if (given(request.if_match)) {
    if (!lists(request.if_match, current.etag, false)) return Precondition::failed;
  } else if (given(request.if_unmodified_since)) {
    const auto since = parse_http_date(request.if_unmodified_since);
    if (since && current.modified_s > *since) return Precondition::failed;
  }
  if (given(request.if_none_match))
    return lists(request.if_none_match, current.etag, true) ? Precondition::not_modified
                                                            : Precondition::holds;
  if (given(request.if_modified_since)) {
    const auto since = parse_http_date(request.if_modified_since);
    if (since && current.modified_s <= *since) return Precondition::not_modified;
  }
  return Precondition::holds;
}

bool range_counts(const Request& request, const Validators& current) {
  if (!given(request.if_range)) return true;
  if (request.if_range.starts_with('"')) return request.if_range == current.etag;
  const auto date = parse_http_date(request.if_range);
  return date && *date == current.modified_s;
}

}  // namespace cuesta::serve
