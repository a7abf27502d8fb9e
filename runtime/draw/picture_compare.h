#pragma once
/// How much two pictures differ: exact channel counts for golden images, SSIM for levels of detail.

#include <array>
#include <cstdint>

#include "runtime/draw/picture.h"

namespace cuesta {

/// Over the four channels, on the 0…255 scale.
struct PictureDifference {
  int max_channel = 0;      ///< largest difference of any channel of any pixel
  double mean_channel = 0;  ///< mean absolute difference over all channels and pixels
  double ssim = 1;          ///< mean structural similarity of the luma, ≤ 1; 1 is equal
  std::array<std::uint64_t, 256>
      pixels_by_difference{};  ///< histogram of each pixel's largest channel difference

  /// Fraction of the pixels of which no channel differs by more than `tolerance` (0…255).
  double fraction_within(int tolerance) const;
};

/// SSIM over 8 × 8 windows every 4 pixels, uniform weights (smaller pictures: one window).
/// Source: Wang et al., "Image Quality Assessment: From Error Visibility to Structural Similarity", IEEE TIP
/// 2004, §III; deviation: uniform instead of Gaussian windows, as in the paper's earlier form.
/// @pre   both have the same size and at least one pixel.   @cost  O(pixels), 16 bytes per pixel of scratch.
PictureDifference compare(const Picture& a, const Picture& b);

}  // namespace cuesta
