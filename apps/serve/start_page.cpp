#include "apps/serve/start_page.h"

#include <fmt/format.h>

#include <array>
#include <iterator>

#include "apps/serve/target.h"

namespace cuesta::serve {
namespace {

constexpr std::string_view head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Cuesta</title>
<style>
:root { color-scheme: light dark; --line: #8884; --soft: #8882; }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 0 auto; padding: 2rem 1.25rem; }
h1 { font-size: 1.5rem; margin: 0 0 .25rem; }
p.lead { margin: 0 0 2rem; opacity: .75; }
ul { list-style: none; margin: 0; padding: 0; display: grid; gap: 1.25rem;
     grid-template-columns: repeat(auto-fill, minmax(17rem, 1fr)); }
li { border: 1px solid var(--line); border-radius: .6rem; overflow: hidden; display: flex; flex-direction: column; }
li img { display: block; width: 100%; height: auto; aspect-ratio: 4 / 3; background: var(--soft); }
.facts { padding: .9rem 1rem 1rem; display: flex; flex-direction: column; gap: .35rem; flex: 1; }
h2 { font-size: 1.05rem; margin: 0; overflow-wrap: anywhere; }
.numbers, .attribution { font-size: .875rem; opacity: .8; margin: 0; }
.attribution { font-style: italic; overflow-wrap: anywhere; }
.links { margin: auto 0 0; padding-top: .5rem; display: flex; flex-wrap: wrap; gap: .25rem 1rem; font-size: .9rem; }
a:focus-visible { outline: 3px solid; outline-offset: 2px; }
</style>
</head>
<body>
<h1>Cuesta</h1>
)";
constexpr std::string_view foot = "</body>\n</html>\n";

std::string escaped_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// "1.2 million", "340,000": what people take in at a glance.
std::string glance(std::uint64_t n) {
  const auto value = static_cast<double>(n);
  if (n >= 1'000'000'000) return fmt::format("{:.1f} billion", value / 1e9);
  if (n >= 1'000'000) return fmt::format("{:.1f} million", value / 1e6);
  return n >= 1000 ? fmt::format("{},{:03}", n / 1000, n % 1000) : std::to_string(n);
}

std::string size_text(std::uint64_t bytes) {
  constexpr std::array<std::string_view, 5> units{"bytes", "KiB", "MiB", "GiB", "TiB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 1024 && unit + 1 < units.size(); ++unit) value /= 1024;
  return unit == 0 ? fmt::format("{} bytes", bytes) : fmt::format("{:.1f} {}", value, units[unit]);
}

/// "Terrain, 1.2 million triangles, 3.4 MiB", and how large it is where that is known.
std::string numbers(const Dataset& set) {
  std::string text = fmt::format("{}{} triangles, {}",
                                 set.is_terrain ? "Terrain, "
                                 : set.is_scene ? "Scene, "
                                                : "",
                                 glance(set.triangles), size_text(set.file->bytes()));
  const Vec3d size = set.box.hi - set.box.lo;
  return text + fmt::format("<br>{:.4g} × {:.4g} × {:.4g}", size.x, size.y, size.z);
}

void put_picture(fmt::memory_buffer& out, const Dataset& set, const std::string& place) {
  fmt::format_to(
      std::back_inserter(out),
      "<img src=\"/thumbnail/{}.png?v={}\" alt=\"\" width=\"480\" height=\"360\" loading=\"lazy\">", place,
      set.version());
}

void put_tile_links(fmt::memory_buffer& out, const Dataset& set, const std::string& place,
                    const std::string& name) {
  const auto to = std::back_inserter(out);
  if (set.has_tiles(TileKind::tiles_3d))
    fmt::format_to(to, "<a href=\"/tiles/{}/tileset.json\" aria-label=\"3D Tiles of {}\">3D Tiles</a>", place,
                   name);
  if (set.has_tiles(TileKind::terrain))
    fmt::format_to(to, "<a href=\"/terrain/{}/layer.json\" aria-label=\"Terrain tiles of {}\">Terrain</a>",
                   place, name);
}

void put_card(fmt::memory_buffer& out, const Dataset& set, bool has_page, bool has_tiles) {
  const std::string place = escaped_path(set.name), name = escaped_html(set.name);
  const auto to = std::back_inserter(out);
  const std::string view = fmt::format("/view/?data=/data/{}.cuesta", place);
  fmt::format_to(to, "<li>\n");
  if (has_page) fmt::format_to(to, "<a href=\"{}\">", view);
  put_picture(out, set, place);
  fmt::format_to(to, "{}\n<div class=\"facts\">\n<h2>{}</h2>\n", has_page ? "</a>" : "", name);
  fmt::format_to(to, "<p class=\"numbers\">{}</p>\n", numbers(set));
  if (!set.attribution.empty())
    fmt::format_to(to, "<p class=\"attribution\">{}</p>\n", escaped_html(set.attribution));
  fmt::format_to(to, "<p class=\"links\">");
  if (has_page) fmt::format_to(to, "<a href=\"{}\" aria-label=\"View {}\">View</a>", view, name);
  fmt::format_to(to, "<a href=\"/data/{0}.cuesta\" aria-label=\"Download {1}\" download>Download</a>", place,
                 name);
  if (has_tiles) put_tile_links(out, set, place, name);
  fmt::format_to(to,
                 "<a href=\"/api/datasets/{0}\" aria-label=\"Facts of {1}\">Facts</a></p>\n</div>\n</li>\n",
                 place, name);
}

}  // namespace

std::string start_page(const Contents& contents, bool has_tiles) {
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  const std::size_t count = contents.datasets.size();
  fmt::format_to(to, "{}<p class=\"lead\">{} data set{}. <a href=\"/api/datasets\">As JSON</a></p>\n<ul>\n",
                 head, count, count == 1 ? "" : "s");
  const bool has_page = contents.page_files.contains("index.html");
  for (const auto& set : contents.datasets) put_card(out, *set, has_page, has_tiles);
  fmt::format_to(to, "</ul>\n{}", foot);
  return fmt::to_string(out);
}

}  // namespace cuesta::serve
