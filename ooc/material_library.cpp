#include "ooc/material_library.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "ooc/mapped_file.h"
#include "ooc/obj_data.h"

namespace cuesta {
namespace {

constexpr std::uint64_t largest_library = std::uint64_t{64} << 20;

float unit(double value) {
  return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

/// Exponent of Phong's highlight → roughness of a microfacet one, as wide.
double roughness_of_exponent(double exponent) {
  return std::sqrt(2 / (std::max(exponent, 0.0) + 2));
}

class Parser {
 public:
  MaterialLibrary parse(std::span<const char> bytes) {
    ObjStatements statements(bytes);
    TextCursor line;
    while (statements.next(line)) {
      line.skip_blanks();
      const std::string_view word = line.word();
      if (word == "newmtl")
        begin(obj_rest(line));
      else if (is_open_)
        take(word, line);
    }
    return std::move(library_);
  }

 private:
  void begin(std::string_view name) {
    is_open_ = names_.emplace(name).second;
    is_textured_ = has_roughness_ = false;
    if (is_open_) library_.materials.push_back({std::string(name), {255, 255, 255, 255}, 0, 1, false});
  }

  void take(std::string_view word, TextCursor line) {
    SceneMaterial& m = library_.materials.back();
    std::array<double, 3> v{};
    if (word == "map_Kd" && !std::exchange(is_textured_, true)) ++library_.textured;
    const std::size_t n = obj_numbers(line, v);
    if (n == 0 || !std::isfinite(v[0] + v[1] + v[2])) return;
    if (word == "Kd" && n == 3)
      for (std::size_t k = 0; k < 3; ++k) m.base_colour[k] = colour_byte(255 * v[k]);
    if (word == "d") m.base_colour[3] = colour_byte(255 * v[0]);
    if (word == "Tr") m.base_colour[3] = colour_byte(255 * (1 - v[0]));
    if (word == "Pm") m.metallic = unit(v[0]);
    if (word == "Pr") has_roughness_ = true;
    if (word == "Pr") m.roughness = unit(v[0]);
    if (word == "Ns" && !has_roughness_) m.roughness = unit(roughness_of_exponent(v[0]));
  }

  MaterialLibrary library_;
  std::unordered_set<std::string> names_;
  bool is_open_ = false, is_textured_ = false, has_roughness_ = false;
};

}  // namespace

Result<MaterialLibrary> read_material_library(const std::filesystem::path& path) {
  auto file = MappedFile::open(path);
  if (!file) return fail(std::move(file).error());
  if (file->bytes().size() > largest_library)
    return fail(ErrorCode::out_of_budget, path.string(), "", "more than 64 MiB of materials");
  MaterialLibrary library = Parser().parse(file->bytes());
  CUESTA_TRY(file->check_unchanged());
  return library;
}

}  // namespace cuesta
