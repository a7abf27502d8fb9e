/// Whatever a client sends: a head is refused or answered, and what is answered of a file lies within it.

#include <cstdlib>

#include "apps/serve/file_response.h"
#include "apps/serve/http_date.h"
#include "apps/serve/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cuesta::serve;
  constexpr std::uint64_t file_bytes = 1000;
  static const auto file = std::make_shared<const ServedFile>(make_served_file(
      Descriptor(), {1, 2, file_bytes, 784111777'000'000'000, 0}, "a-1", "application/vnd.cuesta"));
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  std::size_t scanned = 0;
  const std::size_t length = head_length(bytes, scanned);
  Request request;
  if (length == 0 || parse_request(bytes.substr(0, length), request) != 0) return 0;
  Target target;
  if (parse_target(request.target, target) && (target.path + '/').find("/../") != std::string::npos)
    std::abort();
  if (request.method != Method::get && request.method != Method::head) return 0;
  Response response;
  std::vector<ByteRange> ranges;
  respond_file(response, {request, http_date(0)}, file, "", ranges);
  for (const Piece& p : response.pieces) {
    const std::uint64_t end = p.of_file ? file_bytes : response.text.size();
    if (p.first > end || p.count > end - p.first) std::abort();
  }
  return 0;
}
