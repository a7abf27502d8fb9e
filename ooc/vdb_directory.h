#pragma once
/// The grids of an OpenVDB file, from its header alone: what is asked for, and whether the file is whole, is
/// known before OpenVDB sees a byte of it.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ooc/read_job.h"

namespace cuesta {

struct VdbGrid {
  std::string name;  ///< as OpenVDB's readGrid() takes it: "density", or "density[1]" where names repeat
  std::string type;  ///< "Tree_float_5_4_3"; without the suffix of grids that are saved as half
  bool half = false;
  std::uint64_t topology_byte = 0;  ///< where its metadata and tree begin
  std::uint64_t values_byte = 0;    ///< where the values of its leaf nodes begin
  std::uint64_t end_byte = 0;       ///< within the file

  bool is_scalar() const { return type == "Tree_float_5_4_3" || type == "Tree_double_5_4_3"; }
};

/// True for the eight bytes that every .vdb file begins with.
bool is_vdb(std::span<const char> bytes);

/// All grids in the order of the file. @error corrupt: also when the file is cut short, wherever that is;
/// unsupported_version: written by OpenVDB older than 1.0, or as a stream, without the grids' places.
Result<std::vector<VdbGrid>> read_vdb_directory(const ReadJob& job);

/// The grid called `name` ("density" means the first of several), or the first scalar one if `name` is empty.
/// @error not_found, invalid_input: with all grids and their types in the message.
Result<VdbGrid> choose_vdb_grid(const ReadJob& job, const std::vector<VdbGrid>& grids,
                                const std::string& name);

}  // namespace cuesta
