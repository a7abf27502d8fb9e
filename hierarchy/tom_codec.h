#pragma once
/// A TOM ⇄ segments of bytes: each brings the vertices from one resolution up to the next, with their
/// triangles, substitutes and errors. The first ones alone are the TOM up to their resolution; the rest can
/// stream in. docs/format.md describes a segment byte by byte.
///
/// A corner of a triangle may be a vertex that is not there yet. So a segment gives each triangle with the
/// corners that it has at the segment's own resolution, and the next segment says which of the new vertices
/// corners become: the steps down the tree of substitutes, mostly one byte before compression.

#include <cstddef>
#include <span>
#include <vector>

#include "hierarchy/tom.h"
#include "ooc/result.h"

namespace cuesta {

/// The TOM up to resolution n: what the segments up to there decode to.
/// @pre base_vertices ≤ n ≤ full()
Tom tom_prefix(const Tom& tom, Resolution n);

/// Whole resolutions for segments, rising: from about `first` vertices on, each has `ratio` times as many,
/// the last is full(). One, if the TOM is small; none without vertices.
std::vector<Resolution> segment_resolutions(const Tom& tom, Resolution first = 1024, std::uint32_t ratio = 4);

/// The segment that brings vertices `from` … `to` - 1.
/// @param from  0 for the first segment, else where the one before ends
/// @pre   from < to, base_vertices ≤ to ≤ full(); normals and texture coordinates are what snap_attributes
/// makes
std::vector<std::byte> encode_tom_segment(const Tom& tom, Resolution from, Resolution to);

/// Appends a segment to what those before it gave: an empty Tom before the first.
/// Hostile bytes give an error, never a bad TOM.
/// @error corrupt, unsupported_version; invalid_input for a segment that is not the next one. `tom` is then
///        as it was.
/// @cost  memory: at most 65,536 times the bytes given; time linear in what is there afterwards.
Result<void> decode_tom_segment(std::span<const std::byte> bytes, Tom& tom);

/// Rounds normals (octahedral, normal_bits) and texture coordinates (2^-16) to what segments can store.
void snap_attributes(Tom& tom);

}  // namespace cuesta
