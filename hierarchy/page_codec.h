#pragma once
/// The in-memory page ⇄ bytes: the one place that knows how a page is stored. docs/format.md describes it
/// byte by byte.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hierarchy/page.h"
#include "ooc/result.h"

namespace cuesta {

/// What a page's bytes are spent on.
enum class PageStream : std::uint8_t {
  triangles,
  positions,
  normals,
  colours,
  texcoords,
  fan_centres,
  fan_sizes,
  fan_spheres,
  child_vertices,
  child_errors,
  child_wedges,
  wedge_tails,
  orphans,
  source_triangles,
  source_vertices,
  count
};
inline constexpr std::size_t page_stream_count = static_cast<std::size_t>(PageStream::count);
std::string_view name(PageStream stream);
using PageStreamBytes = std::array<std::uint64_t, page_stream_count>;

/// Encodes a page, but for survivors, which coarser pages have. @param spent  if given, the stored size of
/// each stream is added to it.
/// @pre triangles are smallest_first, fans and children index vertices, owned arrays match the script.
std::vector<std::byte> encode_page(const Page& page, PageStreamBytes* spent = nullptr);

/// The stored size of each stream of an encoded page, as encode_page counts them: nothing is unpacked.
/// @error corrupt, unsupported_version.
Result<PageStreamBytes> bytes_per_stream(std::span<const std::byte> page);

/// No page has more vertices, triangles or children than this.
inline constexpr std::uint32_t max_page_elements = 1u << 22;

/// Decodes what encode_page gave, checking every count and index: hostile bytes give an error, never a bad
/// page.
/// @param survivors  as Page::survivors
/// @error corrupt, unsupported_version (place: the stream). Memory: bounded by max_page_elements, and by
/// 65,536
///        times the bytes given.
Result<Page> decode_page(std::span<const std::byte> bytes, std::span<const Vec3i> survivors);

}  // namespace cuesta
