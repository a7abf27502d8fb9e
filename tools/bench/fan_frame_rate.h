#pragma once
/// Pictures of both of cuesta-bench-fan's methods by the same renderer: what a whole frame costs.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ooc/result.h"
#include "runtime/draw/renderer.h"
#include "tools/baselines/view_dependence_tree.h"

namespace cuesta::bench {

class FrameRate {
 public:
  /// @param tree  its full resolution gives the normals.   @error of the context and the renderer.
  static Result<FrameRate> create(const Grid& grid, const baselines::ViewDependenceTree& tree);

  /// Processor time of uploading what the list says has changed, and of the picture, until it is finished.
  Result<double> draw_fan(const DrawList& list, const View& view);
  /// The same of a drawing list, which is uploaded whole; its vertices are uploaded once.
  Result<double> draw_tree(std::span<const std::array<std::uint32_t, 3>> triangles, const View& view);

 private:
  FrameRate(const Grid& grid, const baselines::ViewDependenceTree& tree, std::unique_ptr<Renderer> fan,
            std::unique_ptr<Renderer> tree_renderer);

  Grid grid_;
  std::vector<DrawVertex> vertices_;
  std::unique_ptr<Renderer> fan_, tree_;
};

}  // namespace cuesta::bench
