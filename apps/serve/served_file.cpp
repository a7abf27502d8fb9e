#include "apps/serve/served_file.h"

#include <fmt/format.h>

#include "apps/serve/http_date.h"

namespace cuesta::serve {

ServedFile make_served_file(Descriptor descriptor, const FileStamp& stamp, std::string_view tag,
                            std::string content_type) {
  ServedFile file{std::move(descriptor), stamp, fmt::format("\"{}\"", tag), std::move(content_type), {}};
  file.validator_lines = fmt::format("ETag: {}\r\nLast-Modified: {}\r\nAccept-Ranges: bytes\r\n", file.etag,
                                     http_date(file.modified_s()));
  return file;
}

}  // namespace cuesta::serve
