#pragma once
/// A mesh decoded by the Draco library, behind a header without Draco's: for .drc files and for glTF's
/// KHR_draco_mesh_compression.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "ooc/read_job.h"

namespace cuesta {

enum class DracoSemantic : std::uint8_t { position, normal, colour, texcoord };

class DracoMesh {
 public:
  /// Decodes a whole Draco bitstream. Draco cannot stream: what decoding needs, `bytes` themselves included,
  /// is charged for `budget` from the counts in the bitstream's header before it starts, what the mesh keeps
  /// is charged until the mesh is destroyed. Not guaranteed: libdraco 1.5.5 trusts one count inside its
  /// texture coordinate prediction, so that a hostile file of any size can cost about 20 s and 256 MiB more
  /// before it is refused.
  /// @error corrupt; unsupported_version for point clouds; out_of_budget. Never throws. `budget` must outlive
  /// the mesh.
  static Result<DracoMesh> decode(std::span<const char> bytes, ReadBudget& budget);
  DracoMesh(DracoMesh&&) noexcept;
  DracoMesh& operator=(DracoMesh&&) noexcept;
  ~DracoMesh();

  std::uint32_t vertices() const;
  std::uint32_t triangles() const;
  /// Indices are as stored: the caller compares them with vertices().
  std::array<std::uint32_t, 3> triangle(std::uint32_t i) const;

  /// Number of an attribute for read(), or -1: the first of a meaning, or the one with a glTF unique id.
  int find(DracoSemantic semantic) const;
  int find_id(std::uint32_t unique_id) const;
  int components(int attribute) const;

  /// Values of vertices first … first + count - 1, `stride` numbers apart; of `stride` components the
  /// attribute lacks are left as they are. Whole types are divided by their largest value if `normalised`.
  void read(int attribute, bool normalised, std::uint32_t first, std::uint32_t count, std::size_t stride,
            double* out) const;
  /// True if the attribute is stored as whole numbers that stand for 0…1 or -1…1.
  bool is_normalised(int attribute) const;
  bool is_real(int attribute) const;  ///< stored as float or double

 private:
  struct Impl;
  explicit DracoMesh(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace cuesta
