#include "apps/serve/response.h"

#include <array>
#include <charconv>

namespace cuesta::serve {

void Response::clear() {
  status = 200;
  close = false;
  text.clear();
  pieces.clear();
  file.reset();
  later = nullptr;
  upgrade = nullptr;
}

HeadWriter::HeadWriter(Response& response, const ResponseFrame& frame, int status) : response_(response) {
  response.clear();
  response.status = status;
  response.close = !frame.request.keep_alive;
  response.text += "HTTP/1.1 ";
  response.text += static_cast<char>('0' + status / 100);
  response.text += static_cast<char>('0' + status / 10 % 10);
  response.text += static_cast<char>('0' + status % 10);
  response.text += ' ';
  response.text += reason_phrase(status);
  response.text += "\r\nServer: cuesta\r\n";
  header("Date", frame.date);
  if (response.close)
    header("Connection", "close");
  else if (frame.request.is_http_1_0)
    header("Connection", "keep-alive");
}

void HeadWriter::header(std::string_view name, std::string_view value) {
  response_.text += name;
  response_.text += ": ";
  response_.text += value;
  response_.text += "\r\n";
}

void HeadWriter::header(std::string_view name, std::uint64_t value) {
  std::array<char, 20> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  header(name, std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data())));
}

void HeadWriter::end() {
  response_.text += "\r\n";
  response_.pieces.push_back({false, 0, response_.text.size()});
}

void respond_text(Response& response, const ResponseFrame& frame, int status, std::string_view content_type,
                  std::string_view body, std::string_view extra) {
  HeadWriter head(response, frame, status);
  head.header("Content-Type", content_type);
  head.header("Content-Length", body.size());
  head.header("X-Content-Type-Options", "nosniff");
  head.lines(extra);
  head.end();
  if (frame.request.method == Method::head) return;
  response.text += body;
  response.pieces.back().count = response.text.size();
}

void respond_refusal(Response& response, const ResponseFrame& frame, int status, std::string_view sentence,
                     std::string_view extra) {
  std::string body(sentence);
  body += '\n';
  respond_text(response, frame, status, "text/plain; charset=utf-8", body, extra);
}

std::string_view reason_phrase(int status) {
  switch (status) {
    case 101:
      return "Switching Protocols";
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 206:
      return "Partial Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 412:
      return "Precondition Failed";
    case 413:
      return "Content Too Large";
    case 416:
      return "Range Not Satisfiable";
    case 426:
      return "Upgrade Required";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return status < 500 ? "Refused" : "Internal Server Error";
  }
}

int http_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::not_found:
      return 404;
    case ErrorCode::invalid_input:
      return 400;
    case ErrorCode::out_of_budget:
    case ErrorCode::cancelled:
      return 503;
    case ErrorCode::corrupt:
    case ErrorCode::unsupported_version:
    case ErrorCode::io:
      return 500;
  }
  return 500;
}

}  // namespace cuesta::serve
