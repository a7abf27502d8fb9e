#pragma once
/// Postings of all layers as seen from one: in columns and rows of its lattice, which is the plane that
/// covering and seams are decided in.

#include <cmath>

#include "terrain/mosaic_layers.h"

namespace cuesta {

class LatticeView {
 public:
  /// @param first_column  where the layer's columns are counted modulo columns_around, those of places are in
  ///                      [first_column, first_column + columns_around).
  LatticeView(std::span<const MosaicLayer> layers, std::uint32_t layer, double first_column)
      : layers_(layers), layer_(layer), first_column_(first_column) {}

  const MosaicLayer& layer() const { return layers_[layer_]; }
  /// x: column, y: row (southward); NaN where a place has no coordinates in the layer's system.
  PlanePoint at(std::uint32_t of_layer, double column, double row) const;
  PlanePoint at(const PostingRef& posting) const {
    return at(posting.layer, double(posting.column), double(posting.row));
  }
  /// The image of `p` that is nearest to `to`, by whole turns.
  PlanePoint near(PlanePoint p, PlanePoint to) const {
    const auto around = double(layer().columns_around);
    if (around > 0) p.x -= around * std::round((p.x - to.x) / around);
    return p;
  }

 private:
  std::span<const MosaicLayer> layers_;
  std::uint32_t layer_;
  double first_column_;
};

}  // namespace cuesta
