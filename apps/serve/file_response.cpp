#include "apps/serve/file_response.h"

#include <fmt/format.h>

#include "apps/serve/conditions.h"

namespace cuesta::serve {
namespace {

/// No file has it in its bytes by intention, and a client goes by lengths: Content-Range is in every part.
constexpr std::string_view boundary = "cuesta-5f0c1e9ab7d34e26";

std::string_view format_into(fmt::memory_buffer& buffer, const ByteRange& range, std::uint64_t file_bytes) {
  buffer.clear();
  fmt::format_to(std::back_inserter(buffer), "bytes {}-{}/{}", range.first, range.first + range.count - 1,
                 file_bytes);
  return {buffer.data(), buffer.size()};
}

void write_validators(HeadWriter& head, const ServedFile& file, std::string_view extra) {
  head.lines(file.validator_lines);
  head.lines(extra);
}

void add_text(Response& response, std::string_view text) {
  const std::uint64_t first = response.text.size();
  response.text += text;
  response.pieces.push_back({false, first, text.size()});
}

void respond_one(Response& response, const ResponseFrame& frame, const ServedFile& file,
                 std::string_view extra, const ByteRange& range, bool partial) {
  HeadWriter head(response, frame, partial ? 206 : 200);
  head.header("Content-Type", file.content_type);
  head.header("Content-Length", range.count);
  if (partial) {
    fmt::memory_buffer words;
    head.header("Content-Range", format_into(words, range, file.bytes()));
  }
  write_validators(head, file, extra);
  head.end();
  if (frame.request.method == Method::get && range.count > 0)
    response.pieces.push_back({true, range.first, range.count});
}

/// The text before a part of multipart/byteranges.
std::string part_head(const ServedFile& file, const ByteRange& range) {
  fmt::memory_buffer words;
  return fmt::format("\r\n--{}\r\nContent-Type: {}\r\nContent-Range: {}\r\n\r\n", boundary, file.content_type,
                     format_into(words, range, file.bytes()));
}

void respond_parts(Response& response, const ResponseFrame& frame, const ServedFile& file,
                   std::string_view extra, const std::vector<ByteRange>& ranges) {
  const std::string end = fmt::format("\r\n--{}--\r\n", boundary);
  std::uint64_t length = end.size();
  for (const ByteRange& r : ranges) length += part_head(file, r).size() + r.count;
  HeadWriter head(response, frame, 206);
  head.header("Content-Type", fmt::format("multipart/byteranges; boundary={}", boundary));
  head.header("Content-Length", length);
  write_validators(head, file, extra);
  head.end();
  if (frame.request.method == Method::head) return;
  for (const ByteRange& r : ranges) {
    add_text(response, part_head(file, r));
    response.pieces.push_back({true, r.first, r.count});
  }
  add_text(response, end);
}

}  // namespace

void respond_file(Response& response, const ResponseFrame& frame, std::shared_ptr<const ServedFile> file,
                  std::string_view extra, std::vector<ByteRange>& ranges) {
  const Request& request = frame.request;
  const Validators current{file->etag, file->modified_s()};
  const Precondition precondition = check_preconditions(request, current);
  if (precondition == Precondition::failed)
    return respond_refusal(response, frame, 412, "The file is another one now.", extra);
  if (precondition == Precondition::not_modified) {
    HeadWriter head(response, frame, 304);
    write_validators(head, *file, extra);
    return head.end();
  }
  const bool ranged = request.method == Method::get && range_counts(request, current);
  const RangeAnswer answer = parse_ranges(ranged ? request.range : std::string_view(), file->bytes(), ranges);
  if (answer == RangeAnswer::refused) {
    const std::string size = fmt::format("Content-Range: bytes */{}\r\n{}", file->bytes(), extra);
    return respond_refusal(response, frame, 416, "The file has no such ranges, or they are too many.", size);
  }
  if (answer == RangeAnswer::whole)
    respond_one(response, frame, *file, extra, {0, file->bytes()}, false);
  else if (ranges.size() == 1)
    respond_one(response, frame, *file, extra, ranges.front(), true);
  else
    respond_parts(response, frame, *file, extra, ranges);
  response.file = std::move(file);
}

}  // namespace cuesta::serve
