#include "terrain/lattice_view.h"

namespace cuesta {

PlanePoint LatticeView::at(std::uint32_t of_layer, double column, double row) const {
  const MosaicLayer &to = layer(), &from = layers_[of_layer];
  PlanePoint p{column, row};
  if (of_layer != layer_) {
    PlanePoint place{from.map.x(column, row), from.map.y(column, row)};
    if (!same_coordinates(from.crs.definition(), to.crs.definition()))
      place = to.crs.coordinates(from.crs.lat_lon(place));
    const PostingMap& m = to.map;
    double dx = place.x - m.x0;
    const double dy = place.y - m.y0;
    if (to.crs.geographic()) {  // the image nearest to the layer's middle, also of lattices that do not close
      const double middle = 0.5 * double(to.width) * m.x_per_column, turn = full_turn(to.crs);
      dx -= turn * std::round((dx - middle) / turn);
    }
    const double area = m.x_per_column * m.y_per_row - m.x_per_row * m.y_per_column;
    p = {(dx * m.y_per_row - dy * m.x_per_row) / area, (dy * m.x_per_column - dx * m.y_per_column) / area};
  }
  if (const auto around = double(to.columns_around); around > 0)
    p.x -= around * std::floor((p.x - first_column_) / around);
  return p;
}

}  // namespace cuesta
