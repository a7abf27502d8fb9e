#include "apps/cuesta/text_forms.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

namespace cuesta::app {
namespace {

constexpr int max_picture_px = 16384;

template <class T>
std::optional<T> parse_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

/// Power of two that a unit such as "", "k", "MiB" stands for.
std::optional<int> unit_shift(std::string_view unit) {
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  constexpr std::string_view letters = "kmgt";
  int shift = 0;
  if (!unit.empty()) {
    const auto at = letters.find(static_cast<char>(unit[0] | 0x20));
    if (at != std::string_view::npos) {
      shift = 10 * (static_cast<int>(at) + 1);
      unit.remove_prefix(1);
    }
  }
  if (unit.empty() || unit == "B" || unit == "b" || (shift > 0 && unit == "iB")) return shift;
  return {};
}

std::optional<Vec3d> parse_triple(std::string_view text) {
  Vec3d v;
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = i < 2 ? text.find(',') : text.size();
    if (comma == std::string_view::npos) return {};
    const auto number = parse_number<double>(text.substr(0, comma));
    if (!number || !std::isfinite(*number)) return {};
    v[i] = *number;
    if (i < 2) text.remove_prefix(comma + 1);
  }
  return v;
}

}  // namespace

std::string with_commas(std::uint64_t n) {
  const std::string digits = std::to_string(n);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string byte_count(std::uint64_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  constexpr std::array units{"B", "KiB", "MiB", "GiB", "TiB", "PiB"};
  for (; value >= 1024 && unit + 1 < units.size(); ++unit) value /= 1024;
  return fmt::format("{:.{}f} {}", value, value < 100 ? 1 : 0, units[unit]);
}

std::string duration(double seconds) {
  if (seconds < 10) return fmt::format("{:.2f} s", seconds);
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<std::uint64_t>(seconds + 0.5);
  if (whole < 7200) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::optional<std::uint64_t> parse_bytes(std::string_view text) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789."), text.size());
  const auto value = parse_number<double>(text.substr(0, digits));
  const auto shift = unit_shift(text.substr(digits));
  if (!value || !shift) return {};
  const double bytes = std::ldexp(*value, *shift);
  if (!(bytes >= 0 && bytes < 0x1p60)) return {};
  return static_cast<std::uint64_t>(bytes);
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  double unit = 1;
  if (text.ends_with('k') || text.ends_with('K')) unit = 1e3;
  if (text.ends_with('M')) unit = 1e6;
  if (unit > 1) text.remove_suffix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  value *= unit;
  if (!(value >= 1 && value < 1e18) || value != std::floor(value)) return std::nullopt;
  return static_cast<std::uint64_t>(value);
}

bool parse_picture_size(std::string_view text, int& width_px, int& height_px) {
  const std::size_t cross = text.find('x');
  if (cross == std::string_view::npos) return false;
  const auto width = parse_number<int>(text.substr(0, cross));
  const auto height = parse_number<int>(text.substr(cross + 1));
  if (!width || !height || std::min(*width, *height) < 1 || std::max(*width, *height) > max_picture_px)
    return false;
  width_px = *width;
  height_px = *height;
  return true;
}

std::optional<Rgba8> parse_colour(std::string_view text) {
  if (text == "white") return Rgba8{255, 255, 255, 255};
  if (text == "black") return Rgba8{0, 0, 0, 255};
  if (text == "grey") return Rgba8{128, 128, 128, 255};
  if (text == "transparent") return Rgba8{0, 0, 0, 0};
  if (text.size() != 7 || text[0] != '#') return {};
  Rgba8 colour{0, 0, 0, 255};
  for (std::size_t i = 0; i < 3; ++i) {
    const char* first = text.data() + 1 + 2 * i;
    if (std::from_chars(first, first + 2, colour[i], 16).ptr != first + 2) return {};
  }
  return colour;
}

std::optional<Vec3d> parse_axis(std::string_view text) {
  const double sign = text.starts_with('-') ? -1 : 1;
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  if (text == "x") return Vec3d{sign, 0, 0};
  if (text == "y") return Vec3d{0, sign, 0};
  if (text == "z") return Vec3d{0, 0, sign};
  return {};
}

std::optional<CameraText> parse_camera(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::optional<Vec3d> eye, target, up;
  for (std::string key, value; words >> key;) {
    if (!(words >> value)) return {};
    auto* where = key == "eye" ? &eye : key == "target" ? &target : key == "up" ? &up : nullptr;
    if (!where || !(*where = parse_triple(value))) return {};
  }
  if (!eye || !target || *eye == *target || (up && *up == Vec3d{})) return {};
  return CameraText{*eye, *target, up};
}

}  // namespace cuesta::app
