#pragma once
/// Small components have no legal substitution left: a triangle, a tetrahedron, a sliver of a scan. They are
/// taken as a whole into a vertex of the nearest other component (TOM §4.1: pairs nearer than a threshold may
/// be substituted), so that surfaces of thousands of pieces reach a base page too.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/nearest_points.h"
#include "hierarchy/substitution_kernel.h"
#include "hierarchy/surface_samples.h"

namespace cuesta {

class ComponentAbsorber {
 public:
  /// Both outlive the absorber; components are those that the kernel had at the start.
  ComponentAbsorber(SubstitutionKernel& kernel, SurfaceSamples& samples);
  /// False if there is one component only, and so never a candidate.
  bool has_work() const { return locked_.size() > 1; }

  /// A component and the point that would take it.
  struct Candidate {
    float distance;  ///< largest of its samples to the triangles around `target`, grid units
    std::uint32_t component;
    PointId target;
  };
  /// Components of at most `most_points` points, none locked, with a deviation ≤ `reach`; by rising
  /// deviation. Nothing if there is one component only. @param live  the points that are not removed
  const std::vector<Candidate>& candidates(std::span<const PointId> live, std::uint32_t most_points,
                                           float reach);
  /// Points of a candidate's component, ascending.
  std::span<const PointId> members(const Candidate& candidate) const;
  /// True if the candidate is still what it was: its target has not gone meanwhile.
  bool valid(const Candidate& candidate) const { return !kernel_.star(candidate.target).empty(); }

 private:
  void count(std::span<const PointId> live);
  PointId nearest_target(std::uint32_t component, std::span<const PointId> live);

  SubstitutionKernel& kernel_;
  SurfaceSamples& samples_;
  std::vector<std::uint32_t> component_;        // per point; empty without work
  std::vector<std::uint8_t> locked_;            // per component
  std::vector<std::uint32_t> first_, members_;  // live points by component
  std::vector<float> known_;  // per component: a deviation measured before, a lower guess of the next
  std::unique_ptr<NearestPoints> index_;
  std::vector<Candidate> candidates_;
};

}  // namespace cuesta
