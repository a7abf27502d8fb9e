#include "apps/serve/site.h"

#include <fmt/format.h>

#include <limits>

#include "apps/serve/conditions.h"
#include "apps/serve/file_response.h"
#include "apps/serve/start_page.h"

namespace cuesta::serve {
namespace {

// Pages of other origins may read all that is public here; so may those that are isolated (COEP) embed it.
#define CUESTA_OPEN_TO_ALL                                                                \
  "Access-Control-Allow-Origin: *\r\n"                                                    \
  "Access-Control-Expose-Headers: ETag, Content-Range, Content-Length, Accept-Ranges\r\n" \
  "Cross-Origin-Resource-Policy: cross-origin\r\n"
constexpr std::string_view open_to_all = CUESTA_OPEN_TO_ALL "Cache-Control: no-cache\r\n";
constexpr std::string_view open_and_immutable =
    CUESTA_OPEN_TO_ALL "Cache-Control: public, max-age=31536000, immutable\r\n";
#undef CUESTA_OPEN_TO_ALL
// A page that is isolated may use SharedArrayBuffer.
constexpr std::string_view isolated =
    "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Embedder-Policy: require-corp\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\nX-Content-Type-Options: nosniff\r\nCache-Control: "
    "no-cache\r\n";
constexpr std::string_view start_page_lines =
    "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Embedder-Policy: require-corp\r\n"
    "Content-Security-Policy: default-src 'none'; img-src 'self'; style-src 'unsafe-inline'\r\n"
    "Cache-Control: no-cache\r\n";
constexpr std::string_view preflight_lines =
    "Access-Control-Allow-Origin: *\r\nAccess-Control-Allow-Methods: GET, HEAD, OPTIONS\r\n"
    "Access-Control-Allow-Headers: Accept, Range, If-Range, If-Match, If-None-Match, If-Modified-Since, "
    "If-Unmodified-Since\r\nAccess-Control-Max-Age: 86400\r\nAllow: GET, HEAD, OPTIONS\r\n";
constexpr std::string_view html = "text/html; charset=utf-8", json = "application/json";

/// What is between a prefix and a suffix of `path`; nothing where it does not have both.
std::optional<std::string_view> between(std::string_view path, std::string_view prefix,
                                        std::string_view suffix) {
  if (path.size() <= prefix.size() + suffix.size() || !path.starts_with(prefix) || !path.ends_with(suffix))
    return std::nullopt;
  return path.substr(prefix.size(), path.size() - prefix.size() - suffix.size());
}

std::string datasets_json(const Contents& contents) {
  std::string text = "{\"datasets\":[";
  for (std::size_t i = 0; i < contents.datasets.size(); ++i) {
    if (i > 0) text += ',';
    text += contents.datasets[i]->brief_json;
  }
  return text + "]}\n";
}

/// What a request needs after its bytes are gone.
struct KeptRequest {
  Request request;
  std::string date;

  explicit KeptRequest(const ResponseFrame& frame) : date(frame.date) {
    request.method = frame.request.method;
    request.is_http_1_0 = frame.request.is_http_1_0;
    request.keep_alive = frame.request.keep_alive;
  }
  ResponseFrame frame() const { return {request, date}; }
};

}  // namespace

struct Site::Exchange {
  const ResponseFrame& frame;
  const std::vector<const Counters*>& counters;
  Scratch& scratch;
  Response& response;

  const Contents& contents() const { return *scratch.contents; }
  void not_found() {
    respond_refusal(response, frame, 404, "There is nothing here.", "Cache-Control: no-cache\r\n");
  }
};

void Site::respond(const ResponseFrame& frame, const std::vector<const Counters*>& counters, Scratch& scratch,
                   Response& response) const {
  if (scratch.generation != catalogue_.generation()) {
    scratch.generation = catalogue_.generation();
    scratch.contents = catalogue_.contents();
  }
  const Request& request = frame.request;
  if (request.has_body) {
    respond_refusal(response, frame, 413, "No request with a body is taken.");
    response.close = true;
    return;
  }
  if (request.method == Method::options) {
    HeadWriter head(response, frame, 204);
    head.lines(preflight_lines);
    return head.end();
  }
  if (request.method == Method::other)
    return respond_refusal(response, frame, 405, "Only GET, HEAD and OPTIONS are taken.",
                           "Allow: GET, HEAD, OPTIONS\r\n");
  if (!parse_target(request.target, scratch.target))
    return respond_refusal(response, frame, 400, "The address is not well-formed.");
  Exchange x{frame, counters, scratch, response};
  route(x);
}

void Site::route(Exchange& x) const {
  const std::string_view path = x.scratch.target.path;
  if (const auto name = between(path, "/data/", dataset_suffix)) return data(x, *name);
  if (path == "/")
    return respond_text(x.response, x.frame, 200, html, start_page(x.contents(), parts_.tile != nullptr),
                        start_page_lines);
  if (path == "/api/datasets")
    return respond_text(x.response, x.frame, 200, json, datasets_json(x.contents()), open_to_all);
  if (const auto name = between(path, "/api/datasets/", "")) return dataset_json(x, *name);
  if (const auto name = between(path, "/thumbnail/", ".png")) return thumbnail(x, *name);
  if (const auto name = between(path, "/session/", "")) return session(x, *name);
  if (const auto address = parse_tile_address(path)) return tile(x, *address);
  if (path.starts_with("/view/")) return page_file(x, path.substr(6));
  if (path == "/healthz")
    return respond_text(x.response, x.frame, 200, "text/plain", "ok\n", "Cache-Control: no-store\r\n");
  if (path == "/metrics") return metrics(x);
  x.not_found();
}

/// Header lines of what is made of a data set; nothing, and a refusal, where another version is asked for.
std::optional<std::string_view> Site::caching(Exchange& x, const Dataset& set) {
  const auto version = query_value(x.scratch.target.query, "v");
  if (!version) return open_to_all;
  if (*version == std::string_view(set.file->etag).substr(1, set.file->etag.size() - 2))
    return open_and_immutable;
  respond_refusal(x.response, x.frame, 404, "This version is not served any more.", open_to_all);
  return std::nullopt;
}

void Site::data(Exchange& x, std::string_view name) const {
  const auto set = x.contents().dataset(name);
  if (!set) return x.not_found();
  if (const auto lines = caching(x, *set))
    respond_file(x.response, x.frame, set->file, *lines, x.scratch.ranges);
}

void Site::tile(Exchange& x, const TileAddress& address) const {
  const auto set = x.contents().dataset(address.dataset);
  if (!set || !set->has_tiles(address.kind) || !parts_.tile) return x.not_found();
  const auto lines = caching(x, *set);
  if (!lines) return;
  const std::string etag = fmt::format("\"{}-{}\"", set->version(), parts_.tile_revision);
  const std::string caching_lines = fmt::format("ETag: {}\r\n{}", etag, *lines);
  constexpr auto no_date = std::numeric_limits<std::int64_t>::max();
  const Precondition precondition = check_preconditions(x.frame.request, {etag, no_date});
  if (precondition == Precondition::failed)
    return respond_refusal(x.response, x.frame, 412, "The file is another one now.", open_to_all);
  if (precondition == Precondition::not_modified) {
    HeadWriter head(x.response, x.frame, 304);
    head.lines(caching_lines);
    return head.end();
  }
  x.response.clear();
  x.response.later = [make = parts_.tile, set, kind = address.kind, file = std::string(address.file),
                      caching_lines,
                      kept = KeptRequest(x.frame)](const Client& client, std::function<void(Response)> done) {
    make(set, kind, file, client, [=, done = std::move(done)](const Result<KeptTiles::Bytes>& bytes) {
      Response response;
      const TileFileType type = tile_file_type(file);
      if (bytes)
        respond_text(response, kept.frame(), 200, type.content_type, **bytes,
                     caching_lines + std::string(type.header_lines));
      else
        respond_refusal(response, kept.frame(), http_status(bytes.error().code), bytes.error().text(),
                        open_to_all);
      done(std::move(response));
    });
  };
}

void Site::dataset_json(Exchange& x, std::string_view name) const {
  const auto set = x.contents().dataset(name);
  if (!set) return x.not_found();
  respond_text(x.response, x.frame, 200, json, set->json + "\n", open_to_all);
}

void Site::thumbnail(Exchange& x, std::string_view name) const {
  const auto set = x.contents().dataset(name);
  if (!set || !parts_.thumbnail) return x.not_found();
  x.response.clear();
  x.response.later = [make = parts_.thumbnail, set, kept = KeptRequest(x.frame)](
                         const Client&, std::function<void(Response)> done) {
    make(set, [kept, done = std::move(done)](const Result<std::string>& png) {
      Response response;
      if (png)
        respond_text(response, kept.frame(), 200, "image/png", *png, open_to_all);
      else
        respond_refusal(response, kept.frame(), http_status(png.error().code), png.error().text());
      done(std::move(response));
    });
  };
}

void Site::session(Exchange& x, std::string_view name) const {
  const auto set = x.contents().dataset(name);
  if (!set || !parts_.session) return x.not_found();
  if (!x.frame.request.upgrades_to_websocket)
    return respond_refusal(x.response, x.frame, 426, "This is for WebSocket.",
                           "Upgrade: websocket\r\nConnection: Upgrade\r\n");
  x.response.clear();
  x.response.status = 101;
  x.response.upgrade = [take = parts_.session, set](Descriptor connection, std::string bytes) {
    take(set, std::move(connection), std::move(bytes));
  };
}

void Site::page_file(Exchange& x, std::string_view name) const {
  std::string whole(name);
  if (whole.empty() || whole.ends_with('/')) whole += "index.html";
  const auto at = x.contents().page_files.find(whole);
  if (at == x.contents().page_files.end()) return x.not_found();
  respond_file(x.response, x.frame, at->second, isolated, x.scratch.ranges);
}

void Site::metrics(Exchange& x) const {
  std::vector<Gauge> gauges{
      {"cuesta_datasets", "Files that are served.", static_cast<double>(x.contents().datasets.size())},
      {"cuesta_datasets_unreadable", "Files that cannot be served.",
       static_cast<double>(x.contents().unreadable)}};
  if (parts_.gauges)
    for (const Gauge& g : parts_.gauges()) gauges.push_back(g);
  respond_text(x.response, x.frame, 200, "text/plain; version=0.0.4", metrics_text(x.counters, gauges),
               "Cache-Control: no-store\r\n");
}

}  // namespace cuesta::serve
