#include "terrain/terrain_metadata.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "ooc/check.h"

namespace cuesta {
namespace {

using Json = nlohmann::ordered_json;

template <class Value, std::size_t N>
using Words = std::array<std::pair<const char*, Value>, N>;

constexpr Words<FrameKind, 3> kinds{
    {{"ecef", FrameKind::ecef}, {"enu", FrameKind::enu}, {"projected", FrameKind::projected}}};
constexpr Words<VerticalDatum, 3> datums{{{"unknown", VerticalDatum::unknown},
                                          {"orthometric", VerticalDatum::orthometric},
                                          {"ellipsoidal", VerticalDatum::ellipsoidal}}};
constexpr Words<CrsMethod, 8> methods{{{"geographic", CrsMethod::geographic},
                                       {"transverse_mercator", CrsMethod::transverse_mercator},
                                       {"mercator", CrsMethod::mercator},
                                       {"web_mercator", CrsMethod::web_mercator},
                                       {"lambert_conformal", CrsMethod::lambert_conformal},
                                       {"albers", CrsMethod::albers},
                                       {"polar_stereographic", CrsMethod::polar_stereographic},
                                       {"plane", CrsMethod::plane}}};

template <class Value, std::size_t N>
const char* word_of(const Words<Value, N>& words, Value value) {
  for (const auto& [word, meaning] : words)
    if (meaning == value) return word;
  return "";
}

/// The numbers of a CrsDefinition by their names, so that writing and reading cannot differ.
constexpr std::array<std::pair<const char*, double CrsDefinition::*>, 10> crs_numbers{
    {{"datum_offset_m", &CrsDefinition::datum_offset_m},
     {"unit", &CrsDefinition::unit},
     {"prime_meridian_deg", &CrsDefinition::prime_meridian_deg},
     {"latitude_origin_deg", &CrsDefinition::latitude_origin_deg},
     {"longitude_origin_deg", &CrsDefinition::longitude_origin_deg},
     {"parallel_1_deg", &CrsDefinition::parallel_1_deg},
     {"parallel_2_deg", &CrsDefinition::parallel_2_deg},
     {"scale", &CrsDefinition::scale},
     {"false_easting_m", &CrsDefinition::false_easting_m},
     {"false_northing_m", &CrsDefinition::false_northing_m}}};
constexpr std::array<std::pair<const char*, double GeoBox::*>, 4> box_numbers{
    {{"west", &GeoBox::west_deg},
     {"south", &GeoBox::south_deg},
     {"east", &GeoBox::east_deg},
     {"north", &GeoBox::north_deg}}};

Json json_of(const CrsDefinition& d) {
  Json json{{"name", d.name}, {"datum", d.datum}, {"method", word_of(methods, d.method)}};
  for (const auto& [key, member] : crs_numbers) json[key] = d.*member;
  json["equatorial_radius_m"] = d.ellipsoid.equatorial_radius_m;
  json["inverse_flattening"] = d.ellipsoid.inverse_flattening;
  return json;
}

Json json_of(const Frame& frame) {
  Json json{{"kind", word_of(kinds, frame.kind())}, {"description", frame.description()}};
  if (frame.kind() == FrameKind::enu) {
    const Geodetic at = frame.origin();
    json["origin"] = {{"lat_deg", at.lat_deg}, {"lon_deg", at.lon_deg}, {"h_m", at.h_m}};
  }
  if (const Crs* crs = frame.crs()) json["crs"] = json_of(crs->definition());
  return json;
}

Json json_of(const TerrainFile& f) {
  return {{"name", f.name},
          {"format", f.format},
          {"crs", f.crs},
          {"vertical_datum", word_of(datums, f.vertical_datum)},
          {"vertical_name", f.vertical_name},
          {"postings", f.postings}};
}

/// Takes values out of an object and remembers the first that is missing or of a wrong kind.
class Taker {
 public:
  Taker(const Json& object, std::string place, std::string& fault)
      : object_(object), place_(std::move(place)), fault_(fault) {
    if (!object.is_object()) blame("");
  }

  void take(const char* key, double& out) const {
    if (const Json* value = find(key); value && value->is_number() && std::isfinite(value->get<double>()))
      out = value->get<double>();
    else
      blame(key);
  }
  void take(const char* key, std::uint64_t& out) const {
    if (const Json* value = find(key); value && value->is_number_unsigned())
      out = value->get<std::uint64_t>();
    else
      blame(key);
  }
  void take(const char* key, std::string& out) const {
    if (const Json* value = find(key); value && value->is_string())
      out = value->get<std::string>();
    else
      blame(key);
  }
  template <class Value, std::size_t N>
  void take(const char* key, const Words<Value, N>& words, Value& out) const {
    std::string given;
    take(key, given);
    for (const auto& [word, value] : words) {
      if (given != word) continue;
      out = value;
      return;
    }
    blame(key);
  }
  /// An object within; faults of it are told with this one's key before theirs.
  Taker within(const char* key) const {
    static const Json nothing;
    const Json* value = find(key);
    return {value ? *value : nothing, place_ + "." + key, fault_};
  }
  bool has(const char* key) const { return find(key) != nullptr; }
  /// Calls `each` with a Taker for each entry of a list.
  template <class Each>
  void take_list(const char* key, const Each& each) const {
    const Json* list = find(key);
    if (!list || !list->is_array()) return blame(key);
    for (std::size_t i = 0; i < list->size(); ++i)
      each(Taker((*list)[i], place_ + "." + key + "[" + std::to_string(i) + "]", fault_));
  }

 private:
  const Json* find(const char* key) const {
    if (!object_.is_object()) return nullptr;
    const auto at = object_.find(key);
    return at == object_.end() ? nullptr : &*at;
  }
  void blame(const char* key) const {
    if (fault_.empty()) fault_ = key[0] == '\0' ? place_ : place_ + "." + key;
  }

  const Json& object_;
  std::string place_;
  std::string& fault_;
};

CrsDefinition take_crs(const Taker& from) {
  CrsDefinition d;
  from.take("name", d.name);
  from.take("datum", d.datum);
  from.take("method", methods, d.method);
  for (const auto& [key, member] : crs_numbers) from.take(key, d.*member);
  from.take("equatorial_radius_m", d.ellipsoid.equatorial_radius_m);
  from.take("inverse_flattening", d.ellipsoid.inverse_flattening);
  return d;
}

/// ECEF where the object has faults.
Result<Frame> take_frame(const Taker& from, const std::string& fault) {
  FrameKind kind = FrameKind::ecef;
  from.take("kind", kinds, kind);
  if (kind == FrameKind::enu) {
    const Taker origin = from.within("origin");
    Geodetic at;
    origin.take("lat_deg", at.lat_deg);
    origin.take("lon_deg", at.lon_deg);
    origin.take("h_m", at.h_m);
    if (fault.empty()) return Frame::enu(at);
  }
  if (kind == FrameKind::projected) {
    CrsDefinition definition = take_crs(from.within("crs"));
    if (!fault.empty()) return Frame::ecef();
    auto crs = Crs::from_definition(std::move(definition));
    if (!crs) return fail(crs.error());
    return Frame::projected(std::move(*crs));
  }
  return Frame::ecef();
}

TerrainFile take_file(const Taker& from) {
  TerrainFile f;
  from.take("name", f.name);
  from.take("format", f.format);
  from.take("crs", f.crs);
  from.take("vertical_datum", datums, f.vertical_datum);
  from.take("vertical_name", f.vertical_name);
  from.take("postings", f.postings);
  return f;
}

void take_numbers(const Taker& from, TerrainFacts& facts) {
  from.take("heights", datums, facts.heights);
  from.take("geoid", facts.geoid);
  from.take("least_m", facts.least_m);
  from.take("most_m", facts.most_m);
  from.take("sea_level_m", facts.sea_level_m);
  if (from.has("bounds")) {
    const Taker box = from.within("bounds");
    facts.bounds.emplace();
    for (const auto& [key, member] : box_numbers) box.take(key, *facts.bounds.*member);
  }
  from.take("spacing_m", facts.spacing_m);
  from.take("postings", facts.postings);
  from.take("no_data", facts.no_data);
  from.take("filled", facts.filled);
  from.take("raised", facts.raised);
}

/// What no object has a wrong kind in, but cannot be.
std::string contradiction(const TerrainFacts& f) {
  if (f.least_m > f.most_m) return "terrain.most_m";
  if (!f.bounds) return "";
  const GeoBox& b = *f.bounds;
  const bool is_box = b.west_deg <= b.east_deg && b.south_deg <= b.north_deg && b.south_deg >= -90 &&
                      b.north_deg <= 90 && std::abs(b.west_deg) <= 360 && std::abs(b.east_deg) <= 720;
  return is_box ? "" : "terrain.bounds";
}

}  // namespace

const char* name(VerticalDatum datum) {
  return word_of(datums, datum);
}

std::string terrain_json(const TerrainFacts& f) {
  CUESTA_CHECK(f.least_m <= f.most_m, f.least_m, f.most_m);
  Json json{{"frame", json_of(f.frame)}, {"heights", name(f.heights)}, {"geoid", f.geoid},
            {"least_m", f.least_m},      {"most_m", f.most_m},         {"sea_level_m", f.sea_level_m}};
  if (f.bounds)
    for (const auto& [key, member] : box_numbers) json["bounds"][key] = *f.bounds.*member;
  json["spacing_m"] = f.spacing_m;
  json["postings"] = f.postings;
  json["no_data"] = f.no_data;
  json["filled"] = f.filled;
  json["raised"] = f.raised;
  json["files"] = Json::array();
  for (const TerrainFile& file : f.files) json["files"].push_back(json_of(file));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<std::optional<TerrainFacts>> terrain_facts(std::string_view metadata) {
  const Json json = Json::parse(metadata, nullptr, false);
  if (!json.is_object() || !json.contains("terrain")) return std::optional<TerrainFacts>();
  TerrainFacts facts;
  std::string fault;
  const Taker terrain(json["terrain"], "terrain", fault);
  auto frame = take_frame(terrain.within("frame"), fault);
  if (!frame) return fail(frame.error());
  facts.frame = std::move(*frame);
  take_numbers(terrain, facts);
  terrain.take_list("files", [&](const Taker& file) { facts.files.push_back(take_file(file)); });
  if (fault.empty()) fault = contradiction(facts);
  if (!fault.empty())
    return fail(ErrorCode::corrupt, "", "metadata: " + fault,
                "missing, of a wrong kind or impossible; build the file again");
  return std::optional<TerrainFacts>(std::move(facts));
}

}  // namespace cuesta
