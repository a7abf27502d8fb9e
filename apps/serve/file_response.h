#pragma once
/// GET and HEAD of a file: whole, in ranges, or not at all.   Source: RFC 9110 §13, §14, §15.

#include <memory>
#include <vector>

#include "apps/serve/byte_range.h"
#include "apps/serve/response.h"

namespace cuesta::serve {

/// @param extra   whole header lines of every answer but errors, such as Cache-Control.
/// @param ranges  scratch.
/// @pre the method is GET or HEAD.
void respond_file(Response& response, const ResponseFrame& frame, std::shared_ptr<const ServedFile> file,
                  std::string_view extra, std::vector<ByteRange>& ranges);

}  // namespace cuesta::serve
