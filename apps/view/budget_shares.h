#pragma once
/// One set of budgets for several objects in one world.

#include <span>
#include <vector>

#include "runtime/cut.h"
#include "runtime/view.h"

namespace cuesta::view {

/// How much of the budgets an object should get: the part of the picture that its ball covers, with at least
/// 1 in 50 of the largest share for what is far off or behind the camera.
double visible_weight(const View& view, Vec3d centre, double radius);

/// Shares in proportion to `weights` (positive). Sums never exceed `total`; what is unlimited stays so. Every
/// object may load a page, however small its share.
std::vector<Budgets> share_budgets(const Budgets& total, std::span<const double> weights);

/// Shares of bytes in proportion to `weights`, with the same guarantees.
std::vector<std::uint64_t> share_bytes(std::uint64_t total, std::span<const double> weights);

}  // namespace cuesta::view
