#pragma once
/// A response as it goes to the socket: text, and ranges of one open file between its parts.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/serve/request.h"
#include "apps/serve/served_file.h"
#include "ooc/result.h"

namespace cuesta::serve {

/// Bytes [first, first + count) of Response::text, or of Response::file.
struct Piece {
  bool of_file = false;
  std::uint64_t first = 0, count = 0;
};

/// Who asked, for those who do not answer at once: expired when it has gone.
using Client = std::weak_ptr<const void>;

/// Reused from request to request: then it allocates nothing.
struct Response {
  int status = 200;
  bool close = false;  ///< the connection, after this
  std::string text;
  std::vector<Piece> pieces;
  std::shared_ptr<const ServedFile> file;
  /// If set, the rest is not: it is asked for the response, once, and gives it from any thread when it has
  /// it.
  std::function<void(Client, std::function<void(Response)>)> later;
  /// If set, the rest is not: it is given the connection, with the head of the request and what came after
  /// it.
  std::function<void(Descriptor, std::string)> upgrade;

  void clear();
};

/// What all responses of a moment have in common.
struct ResponseFrame {
  const Request& request;
  std::string_view date;  ///< as http_date()
};

/// A response's head, header by header.
class HeadWriter {
 public:
  /// Begins `response` anew.
  HeadWriter(Response& response, const ResponseFrame& frame, int status);
  void header(std::string_view name, std::string_view value);
  void header(std::string_view name, std::uint64_t value);
  /// Whole lines.
  void lines(std::string_view text) { response_.text += text; }
  /// The empty line; the head becomes the first piece.
  void end();

 private:
  Response& response_;
};

/// A whole response of text. Of HEAD it has the head only.
/// @param extra  whole header lines.
void respond_text(Response& response, const ResponseFrame& frame, int status, std::string_view content_type,
                  std::string_view body, std::string_view extra = {});
/// A sentence for people, as plain text.
void respond_refusal(Response& response, const ResponseFrame& frame, int status, std::string_view sentence,
                     std::string_view extra = {});

std::string_view reason_phrase(int status);
/// The status that tells a client of an error.
int http_status(ErrorCode code);

}  // namespace cuesta::serve
