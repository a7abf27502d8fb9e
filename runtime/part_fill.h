#pragma once
/// How much of its bounds' square a part fills in pictures, hidden or not: learned from what it has filled.
/// A part is mostly filled alike from one frame to the next, while bounds alone say too much of a rod, too
/// little of what has many layers, and nothing of what is all around the eye.

#include <cstdint>
#include <vector>

namespace cuesta {

/// 12 bytes per part.
/// What a drawing call has filled.
struct CallFill {
  float fragments = 0;  ///< of its triangles, hidden ones included
  float pixels = 0;     ///< that it has written
};

class PartFill {
 public:
  explicit PartFill(std::size_t parts) : parts_(parts) {}

  /// Fragments over pixels of bounds, as was measured of late: of the part, or, before it was ever seen,
  /// of all. 1 before anything was.
  double share(std::uint32_t part) const;
  /// In one frame: what instances of a part have filled together, and their bounds.   @param bounds_px > 0
  void add(std::uint32_t part, double fragments, double bounds_px);
  /// Ends the frame: what was added counts half, what was known before the other half.
  void learn();

 private:
  struct Part {
    float share = -1;                    // not known
    float fragments = 0, bounds_px = 0;  // of this frame
  };
  std::vector<Part> parts_;
  std::vector<std::uint32_t> seen_;  // in this frame
  double share_of_all_ = -1;
};

}  // namespace cuesta
