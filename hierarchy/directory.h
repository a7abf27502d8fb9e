#pragma once
/// What is known of every page before it is read, and of the file as a whole.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hierarchy/error_code.h"
#include "hierarchy/page.h"
#include "ooc/byte_stream.h"
#include "ooc/container_file.h"
#include "ooc/grid.h"
#include "ooc/result.h"
#include "ooc/vertical.h"

namespace cuesta {

struct PageEntry {
  BlockRef block;
  std::uint32_t round = 0;
  std::uint32_t vertices = 0;  ///< local, at the start of its round
  std::uint32_t triangles = 0;
  std::uint32_t owned_vertices = 0;
  std::uint32_t owned_triangles = 0;
  ErrorCode8 least_error = 0;    ///< of its substitutions
  ErrorCode8 largest_error = 0;  ///< of its substitutions and those of all pages that lean on it
  Sphere bound;  ///< contains the spheres of its fans, its triangles, and the bounds of the pages
                 ///< that lean on it; grid units
  std::vector<PageId> coarser;  ///< pages of the next round that hold its survivors; empty for the base page
};

struct Directory {
  Grid grid;
  Vec3i lo, hi;                ///< box of all vertices, grid units
  std::uint64_t vertices = 0;  ///< of the full-resolution surface
  std::uint64_t triangles = 0;
  bool has_normals = false, has_colours = false, has_texcoords = false;
  std::optional<Vertical> vertical;  ///< grid units, of a field of heights: its errors are along it
  std::vector<PageEntry> pages;      ///< finer before coarser; the last one is the base page
  std::string metadata;              ///< JSON object: inputs, options, counted warnings, program version

  PageId base() const { return static_cast<PageId>(pages.size() - 1); }
};

/// One entry as the directory stores it.
void put_page_entry(ByteWriter& w, const PageEntry& entry);
/// @param page_count  ids of coarser pages are below it   @return false for damaged bytes
bool get_page_entry(ByteReader& r, std::uint64_t page_count, PageEntry& entry);

std::vector<std::byte> encode_directory(const Directory& directory);
/// @error corrupt. Checks every reference: coarser pages come later and belong to the next round, bounds are
/// finite.
Result<Directory> decode_directory(std::span<const std::byte> bytes);

}  // namespace cuesta
