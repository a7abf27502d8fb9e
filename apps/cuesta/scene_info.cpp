#include "apps/cuesta/scene_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/cuesta/text_forms.h"
#include "apps/overview/file_facts.h"
#include "hierarchy/scene_file.h"

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;

/// Sums over all parts, for the first n segments of each, n = 1, 2, …; surfaces are whole in all of them.
struct Layer {
  std::uint64_t parts = 0, bytes = 0;  ///< that this layer adds to
  std::uint64_t triangles = 0;         ///< of all parts, with it
};

std::vector<Layer> layers_of(const SceneFile& file) {
  std::size_t count = 0;
  for (const ScenePartEntry& p : file.parts()) count = std::max(count, p.segments.size());
  std::vector<Layer> layers(count);
  for (const ScenePartEntry& p : file.parts())
    for (std::size_t k = 0; k < count && !p.segments.empty(); ++k) {
      layers[k].triangles += p.segments[std::min(k, p.segments.size() - 1)].triangles;
      if (k >= p.segments.size()) continue;
      ++layers[k].parts;
      layers[k].bytes += p.segments[k].block.bytes;
    }
  return layers;
}

std::uint64_t bytes_of(const ScenePartEntry& part) {
  std::uint64_t bytes = 0;
  for (const TomSegment& s : part.segments) bytes += s.block.bytes;
  if (part.surface)
    bytes += part.surface->directory.bytes + part.surface->base.bytes + part.surface->pages_bytes;
  return bytes;
}

struct Totals {
  std::uint64_t toms = 0, surfaces = 0, triangles = 0, vertices = 0, instanced = 0;
  std::vector<std::uint64_t> uses;  ///< instances of each part
};

Totals totals_of(const SceneFile& file) {
  Totals t;
  t.uses.resize(file.parts().size());
  for (const ScenePartEntry& p : file.parts()) {
    ++(p.surface ? t.surfaces : t.toms);
    t.triangles += p.triangles;
    t.vertices += p.vertices;
  }
  for (const SceneInstance& i : file.instances()) {
    ++t.uses[i.part];
    t.instanced += file.parts()[i.part].triangles;
  }
  return t;
}

ordered_json json_of(const Box3d& box) {
  return {{"lo", vector_json(box.lo)}, {"hi", vector_json(box.hi)}};
}

ordered_json json_of(const ScenePartEntry& p, std::uint64_t uses) {
  ordered_json json{{"name", p.name},
                    {"kind", p.surface ? "surface" : "tom"},
                    {"triangles", p.triangles},
                    {"vertices", p.vertices},
                    {"instances", uses},
                    {"bytes", bytes_of(p)},
                    {"normals", p.attributes.normals},
                    {"colours", p.attributes.colours},
                    {"box", json_of(p.box)}};
  if (p.surface) return json;
  json["segments"] = ordered_json::array();
  for (const TomSegment& s : p.segments)
    json["segments"].push_back({{"offset", s.block.offset},
                                {"bytes", s.block.bytes},
                                {"vertices", s.vertices},
                                {"triangles", s.triangles},
                                {"error", double{s.error}}});
  return json;
}

std::string scene_json(const SceneFile& file, bool parts) {
  const Totals t = totals_of(file);
  ordered_json json{{"file", file.path().string()},
                    {"kind", "scene"},
                    {"bytes", file.file_bytes()},
                    {"whole_bytes", file.whole_bytes()},
                    {"nodes", file.nodes().size()},
                    {"instances", file.instances().size()},
                    {"parts", file.parts().size()},
                    {"toms", t.toms},
                    {"surfaces", t.surfaces},
                    {"materials", file.materials().size()},
                    {"triangles", t.triangles},
                    {"vertices", t.vertices},
                    {"instanced_triangles", t.instanced}};
  if (const Box3d box = world_box(file.directory()); !box.empty()) json["bounds"] = json_of(box);
  json["clips"] = ordered_json::array();
  for (const SceneClip& clip : file.clips())
    json["clips"].push_back(
        {{"name", clip.name}, {"channels", clip.channels.size()}, {"seconds", clip.seconds()}});
  json["layers"] = ordered_json::array();
  for (const Layer& l : layers_of(file))
    json["layers"].push_back({{"parts", l.parts}, {"bytes", l.bytes}, {"triangles", l.triangles}});
  if (parts) json["part_list"] = ordered_json::array();
  for (std::size_t i = 0; parts && i < file.parts().size(); ++i)
    json["part_list"].push_back(json_of(file.parts()[i], t.uses[i]));
  json["metadata"] = metadata_of(file.directory().metadata);
  return json_text(json, 2) + "\n";
}

void print_parts(const SceneFile& file, const Totals& t) {
  fmt::print("\n{:>6}{:>9}{:>12}{:>11}{:>11}{:>10}  name\n", "part", "kind", "triangles", "vertices",
             "instances", "bytes");
  for (std::size_t i = 0; i < file.parts().size(); ++i) {
    const ScenePartEntry& p = file.parts()[i];
    fmt::print("{:>6}{:>9}{:>12}{:>11}{:>11}{:>10}  {}\n", i, p.surface ? "surface" : "tom",
               with_commas(p.triangles), with_commas(p.vertices), with_commas(t.uses[i]), bytes_of(p),
               p.name);
  }
}

void print_text(const SceneFile& file, bool parts) {
  const Totals t = totals_of(file);
  fmt::print("{}: {}\n", file.path().string(), byte_count(file.file_bytes()));
  if (!file.is_whole())
    fmt::print("  cut off     {} of {} are there\n", byte_count(file.file_bytes()),
               byte_count(file.whole_bytes()));
  fmt::print("  scene       {} nodes, {} instances of {} parts; {} materials\n",
             with_commas(file.nodes().size()), with_commas(file.instances().size()),
             with_commas(file.parts().size()), file.materials().size());
  fmt::print("  parts       {} TOMs, {} fan-hierarchies\n", with_commas(t.toms), with_commas(t.surfaces));
  fmt::print("  triangles   {} in parts, {} in instances\n", with_commas(t.triangles),
             with_commas(t.instanced));
  if (const Box3d box = world_box(file.directory()); !box.empty())
    fmt::print("  bounds      {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g}\n", box.lo.x, box.lo.y, box.lo.z,
               box.hi.x, box.hi.y, box.hi.z);
  for (const SceneClip& clip : file.clips())
    fmt::print("  clip        \"{}\": {} channels, {:.3g} s\n", clip.name, clip.channels.size(),
               clip.seconds());
  fmt::print("\n{:>6}{:>8}{:>12}{:>16}\n", "layer", "parts", "bytes", "triangles then");
  const auto layers = layers_of(file);
  for (std::size_t k = 0; k < layers.size(); ++k)
    fmt::print("{:>6}{:>8}{:>12}{:>16}\n", k, with_commas(layers[k].parts), with_commas(layers[k].bytes),
               with_commas(layers[k].triangles));
  if (parts) print_parts(file, t);
  fmt::print("\nmetadata: {}\n", json_text(metadata_of(file.directory().metadata), 2));
}

}  // namespace

Result<void> run_scene_info(const InfoSettings& settings) {
  const auto file = SceneFile::open(settings.file);
  if (!file) return fail(file.error());
  if (settings.json)
    fmt::print("{}", scene_json(*file, settings.pages));
  else
    print_text(*file, settings.pages);
  return {};
}

}  // namespace cuesta::app
