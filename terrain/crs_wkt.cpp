#include "terrain/crs_wkt.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>

namespace cuesta {
namespace {

constexpr int longest_text =
    65536;  // of a definition that is read at all; real ones have about a thousand bytes

std::optional<int> leading_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end == text.data() || value <= 0) return std::nullopt;
  return value;
}

/// Text without blanks outside of names, in capitals outside of names.
std::string normalized_wkt(std::string_view text) {
  std::string plain;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    const auto byte = static_cast<unsigned char>(c);
    if (!quoted && std::isspace(byte)) continue;
    plain.push_back(quoted ? c : static_cast<char>(std::toupper(byte)));
  }
  std::ranges::replace(plain, '(', '[');  // both kinds of brackets are allowed
  std::ranges::replace(plain, ')', ']');
  return plain;
}

/// The code of the node that is a direct child of the root.
std::optional<int> code_of_root(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted) continue;
    if (text[i] == '[') ++depth;
    if (text[i] == ']') --depth;
    if (depth != 1 || text[i] != ',') continue;
    for (const std::string_view start : {",AUTHORITY[\"EPSG\",\"", ",AUTHORITY[\"EPSG\",", ",ID[\"EPSG\","}) {
      if (text.substr(i).starts_with(start)) {
        if (const auto code = leading_number(text.substr(i + start.size()))) return code;
      }
    }
  }
  return std::nullopt;
}

std::string_view name_of_root(std::string_view text) {
  const std::size_t begin = text.find("[\"");
  if (begin == std::string_view::npos) return {};
  const std::size_t end = text.find('"', begin + 2);
  return end == std::string_view::npos ? std::string_view{} : text.substr(begin + 2, end - begin - 2);
}

struct EsriName {
  std::string_view name;
  int code;
};
constexpr EsriName esri_names[] = {{"GCS_WGS_1984", 4326},
                                   {"GCS_ETRS_1989", 4258},
                                   {"GCS_North_American_1983", 4269},
                                   {"GCS_GDA_1994", 4283},
                                   {"WGS_1984_Web_Mercator_Auxiliary_Sphere", 3857},
                                   {"RGF_1993_Lambert_93", 2154},
                                   {"NZGD_2000_New_Zealand_Transverse_Mercator", 2193},
                                   {"British_National_Grid", 27700},
                                   {"ETRS_1989_LAEA", 3035}};

struct EsriZones {
  std::string_view name;
  char hemisphere;
  int first_zone, last_zone;
  int code_of_zone_0;
};
constexpr EsriZones esri_zones[] = {{"WGS_1984_UTM_Zone_", 'N', 1, 60, 32600},
                                    {"WGS_1984_UTM_Zone_", 'S', 1, 60, 32700},
                                    {"ETRS_1989_UTM_Zone_", 'N', 28, 37, 25800},
                                    {"NAD_1983_UTM_Zone_", 'N', 1, 23, 26900}};

std::optional<int> code_of_esri_name(std::string_view name) {
  for (const EsriName& known : esri_names) {
    if (name == known.name) return known.code;
  }
  for (const EsriZones& zones : esri_zones) {
    if (!name.starts_with(zones.name) || name.back() != zones.hemisphere) continue;
    const std::string_view digits = name.substr(zones.name.size(), name.size() - zones.name.size() - 1);
    const auto zone = digits.size() <= 2 ? leading_number(digits) : std::nullopt;
    if (zone && *zone >= zones.first_zone && *zone <= zones.last_zone) return zones.code_of_zone_0 + *zone;
  }
  return std::nullopt;
}

}  // namespace

std::optional<int> epsg_of_wkt(std::string_view text) {
  if (text.size() > longest_text) return std::nullopt;
  const std::string plain = normalized_wkt(text);
  if (const auto code = code_of_root(plain)) return code;
  return code_of_esri_name(name_of_root(plain));
}

}  // namespace cuesta
