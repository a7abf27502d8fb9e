#pragma once
/// Positions of a page's survivors, gathered from the coarser pages that have it as a source.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hierarchy/directory.h"
#include "ooc/vec.h"

namespace cuesta {

class SurvivorPlaces {
 public:
  explicit SurvivorPlaces(const PageEntry& page)
      : places_(page.vertices - page.owned_vertices), known_(places_.size(), 0) {}

  /// From one coarser page: source `vertices` and `local_vertices` of its table (PageSource), and where its
  /// local vertices are. Vertices that are no survivors are passed over.
  template <class PlaceOf>
  void add(std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> local_vertices,
           PlaceOf place_of) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i] >= places_.size()) continue;
      places_[vertices[i]] = place_of(local_vertices[i]);
      known_[vertices[i]] = 1;
    }
  }

  /// The first survivor that no coarser page has.
  std::optional<std::uint32_t> missing() const;
  /// As Page::survivors.   @pre !missing()
  const std::vector<Vec3i>& places() const { return places_; }

 private:
  std::vector<Vec3i> places_;
  std::vector<std::uint8_t> known_;
};

}  // namespace cuesta
