#pragma once
/// Numbers as people write and read them on a command line.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "runtime/draw/renderer.h"
#include "runtime/view.h"

namespace cuesta::app {

std::string with_commas(std::uint64_t n);     ///< "1,234,567"
std::string byte_count(std::uint64_t bytes);  ///< "12.3 MiB"
std::string duration(double seconds);         ///< "0.42 s", "3 min 20 s"

/// "512M", "1.5 GiB", "65536": bytes; the units K, M, G, T are powers of 1024, B and iB may follow.
std::optional<std::uint64_t> parse_bytes(std::string_view text);
/// "250000", "500k", "1M": a count above 0; k and M are thousands and millions.
std::optional<std::uint64_t> parse_count(std::string_view text);
/// "1280x720": both in 1…16384.
bool parse_picture_size(std::string_view text, int& width_px, int& height_px);
/// "#rrggbb", "white", "black", "grey" or "transparent".
std::optional<Rgba8> parse_colour(std::string_view text);
/// "x", "-x", "y", …: a unit vector along an axis.
std::optional<Vec3d> parse_axis(std::string_view text);

/// A camera as given: what it leaves out is the caller's choice.
struct CameraText {
  Vec3d eye, target;
  std::optional<Vec3d> up;
};
/// "eye 1,2,3 target 0,0,0" and perhaps "up 0,1,0", in any order. The eye must not be at the target.
std::optional<CameraText> parse_camera(std::string_view text);

}  // namespace cuesta::app
