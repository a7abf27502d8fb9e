#include "apps/cuesta/sample_command.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/cuesta/stop_signal.h"
#include "apps/sample/height_sampler.h"
#include "apps/sample/point_list.h"

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;
using sample::HeightSample;
using sample::HeightSampler;
using sample::NumberPair;

Result<std::vector<NumberPair>> all_points(const SampleSettings& s) {
  auto points = sample::pairs_of_words(s.points);
  if (!points || s.from.empty()) return points;
  Result<std::vector<NumberPair>> more;
  if (s.from == "-") {
    more = sample::pairs_of_lines(std::cin, "standard input");
  } else {
    std::ifstream in(s.from);
    if (!in) return fail(ErrorCode::not_found, s.from.string(), "", "cannot be opened");
    more = sample::pairs_of_lines(in, s.from.string());
  }
  if (!more) return more;
  points->insert(points->end(), more->begin(), more->end());
  return points;
}

/// The system of x and y; nothing where points are latitudes and longitudes.
Result<std::optional<Crs>> system_of(const SampleSettings& s, const TerrainFacts& facts) {
  if (!s.xy) return std::optional<Crs>();
  if (!s.crs.empty()) {
    auto crs = Crs::from_name(s.crs);
    if (!crs) return fail(crs.error());
    return std::optional<Crs>(std::move(*crs));
  }
  if (const Crs* own = facts.frame.crs()) return std::optional<Crs>(*own);
  return fail(ErrorCode::invalid_input, s.file.string(), facts.frame.description(),
              "has no x and y of a projection; name one with --crs EPSG:n");
}

Result<std::optional<HeightSample>> sample_at(HeightSampler& terrain, const std::optional<Crs>& crs,
                                              NumberPair point) {
  if (crs) return terrain.at(*crs, {point.first, point.second});
  const auto place = sample::place_of(point);
  if (!place) return fail(place.error());
  return terrain.at(*place);
}

/// "ellipsoidal (geoid egm96-15)", "orthometric"
std::string heights_text(const TerrainFacts& facts) {
  const std::string datum =
      facts.heights == VerticalDatum::unknown ? "above an unknown datum" : name(facts.heights);
  return facts.geoid.empty() ? datum : fmt::format("{} (geoid {})", datum, facts.geoid);
}

void tell(const TerrainFacts& facts, NumberPair asked, const std::optional<HeightSample>& found) {
  if (!found) {
    fmt::print("{} {}  no data there\n", asked.first, asked.second);
    return;
  }
  const Vec3d p = found->position_m;
  const bool is_somewhere = std::isfinite(found->at.lat_deg);  // a plane may be nowhere on the Earth
  const std::string place =
      is_somewhere ? fmt::format("{:.7f} N {:.7f} E; ", found->at.lat_deg, found->at.lon_deg) : "";
  fmt::print("{} {}  {:.2f} m {}; {}x {:.3f} y {:.3f} z {:.3f}\n", asked.first, asked.second, found->at.h_m,
             heights_text(facts), place, p.x, p.y, p.z);
}

ordered_json json_of(NumberPair asked, bool xy, const std::optional<HeightSample>& found) {
  ordered_json json{{xy ? "x" : "lat", asked.first}, {xy ? "y" : "lon", asked.second}};
  json["height_m"] = nullptr;
  if (!found) return json;
  json["height_m"] = found->at.h_m;
  if (xy) {
    json["lat"] = found->at.lat_deg;
    json["lon"] = found->at.lon_deg;
  }
  json["position_m"] = {found->position_m.x, found->position_m.y, found->position_m.z};
  return json;
}

ordered_json head_of(const SampleSettings& s, const TerrainFacts& facts) {
  return {{"file", s.file.string()},
          {"frame", facts.frame.description()},
          {"heights", name(facts.heights)},
          {"geoid", facts.geoid},
          {"points", ordered_json::array()}};
}

}  // namespace

Result<void> run_sample(const SampleSettings& s) {
  auto terrain = HeightSampler::open(s.file);
  if (!terrain) return fail(terrain.error());
  const TerrainFacts& facts = (*terrain)->facts();
  const auto points = all_points(s);
  if (!points) return fail(points.error());
  const auto crs = system_of(s, facts);
  if (!crs) return fail(crs.error());
  ordered_json json = head_of(s, facts);
  for (const NumberPair& point : *points) {
    if (auto r = check_stop(); !r) return r;
    const auto found = sample_at(**terrain, *crs, point);
    if (!found) return fail(found.error());
    if (s.json)
      json["points"].push_back(json_of(point, s.xy, *found));
    else
      tell(facts, point, *found);
  }
  if (s.json) fmt::print("{}\n", json.dump(2, ' ', false, ordered_json::error_handler_t::replace));
  return {};
}

}  // namespace cuesta::app
