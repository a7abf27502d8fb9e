#include "apps/overview/file_facts.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;

ordered_json round_json(const RoundFacts& r, std::size_t number) {
  return {{"round", number},
          {"pages", r.pages},
          {"triangles", r.triangles},
          {"owned_triangles", r.owned_triangles},
          {"bytes", r.bytes},
          {"least_error", r.least_error},
          {"largest_error", r.largest_error}};
}

}  // namespace

Box3d world_box(const Directory& d) {
  Box3d box;
  box.add(d.grid.world(d.lo));
  box.add(d.grid.world(d.hi));
  return box;
}

double snapping_error(const Directory& d) {
  return d.grid.step * std::sqrt(3.0) / 2;
}

double least_error(const Directory& d) {
  return static_cast<double>(decode_error(least_error_code)) * d.grid.step;
}

std::vector<RoundFacts> rounds_of(const Directory& d) {
  std::vector<RoundFacts> rounds;
  for (const PageEntry& e : d.pages) {
    if (e.round >= rounds.size()) rounds.resize(std::size_t{e.round} + 1);
    RoundFacts& r = rounds[e.round];
    const double least = static_cast<double>(decode_error(e.least_error)) * d.grid.step;
    r.least_error = r.pages == 0 ? least : std::min(r.least_error, least);
    r.largest_error =
        std::max(r.largest_error, static_cast<double>(decode_error(e.largest_error)) * d.grid.step);
    ++r.pages;
    r.triangles += e.triangles;
    r.owned_triangles += e.owned_triangles;
    r.bytes += e.block.bytes;
  }
  return rounds;
}

ordered_json metadata_of(const Directory& d) {
  return metadata_of(d.metadata);
}

ordered_json metadata_of(const std::string& text) {
  ordered_json json = ordered_json::parse(text, nullptr, false);
  return json.is_discarded() ? ordered_json(text) : json;
}

ordered_json vector_json(Vec3d v) {
  return ordered_json::array({v.x, v.y, v.z});
}

ordered_json directory_json(const Directory& d) {
  const Box3d box = world_box(d);
  ordered_json json;
  json["triangles"] = d.triangles;
  json["vertices"] = d.vertices;
  json["bounds"] = {{"lo", vector_json(box.lo)}, {"hi", vector_json(box.hi)}};
  json["grid"] = {{"origin", vector_json(d.grid.origin)}, {"step", d.grid.step}};
  json["snapping_error"] = snapping_error(d);
  json["least_error"] = least_error(d);
  json["attributes"] = {
      {"normals", d.has_normals}, {"colours", d.has_colours}, {"texcoords", d.has_texcoords}};
  json["page_count"] = d.pages.size();
  json["rounds"] = ordered_json::array();
  const auto rounds = rounds_of(d);
  for (std::size_t r = 0; r < rounds.size(); ++r) json["rounds"].push_back(round_json(rounds[r], r));
  return json;
}

std::string json_text(const ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace cuesta::app
