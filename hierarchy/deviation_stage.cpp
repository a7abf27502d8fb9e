#include "hierarchy/deviation_stage.h"

#include <algorithm>
#include <span>
#include <utility>

namespace cuesta {

void DeviationStage::Log::add(const Replacement& r, std::uint32_t removed) {
  patch.insert(patch.end(), r.patch.begin(), r.patch.end());
  targets.insert(targets.end(), r.targets.begin(), r.targets.end());
  leaving.insert(leaving.end(), r.leaving.begin(), r.leaving.end());
  corners.insert(corners.end(), r.corners.begin(), r.corners.end());
  entries.push_back({patch.size(), targets.size(), leaving.size(), r.least_error, removed});
}

void DeviationStage::Log::clear() {
  entries.clear();
  patch.clear();
  targets.clear();
  leaving.clear();
  corners.clear();
}

void DeviationStage::add(const Replacement& r, std::uint32_t removed) {
  coming_.add(r, removed);
  if (coming_.entries.size() < most_entries) return;
  tasks_.wait();
  std::swap(coming_, under_way_);
  tasks_.run([this] { measure_all(under_way_); });
}

void DeviationStage::catch_up() {
  tasks_.wait();
  measure_all(coming_);
}

void DeviationStage::measure_all(Log& log) {
  std::size_t patch = 0, targets = 0, leaving = 0;
  for (const Log::Entry& e : log.entries) {
    const Replacement r{std::span(log.patch).subspan(patch, e.patch_end - patch),
                        std::span(log.leaving).subspan(leaving, e.leaving_end - leaving),
                        std::span(log.targets).subspan(targets, e.targets_end - targets),
                        std::span(log.corners).subspan(targets, e.targets_end - targets), e.least_error};
    move(r, samples_.measure(r), e.removed);
    patch = e.patch_end;
    targets = e.targets_end;
    leaving = e.leaving_end;
  }
  log.clear();
}

void DeviationStage::move(const Replacement& r, float deviation, std::uint32_t removed) {
  samples_.move(r);
  error_ = std::max(error_, deviation);
  const ErrorCode8 code = encode_error_up(error_);
  if (code != (errors_.empty() ? ErrorCode8{0} : errors_.back().code)) errors_.push_back({removed, code});
}

float DeviationStage::measure(const Replacement& r) {
  catch_up();
  return measured_ = samples_.measure(r);
}

void DeviationStage::add_measured(const Replacement& r, std::uint32_t removed) {
  move(r, measured_, removed);
}

float DeviationStage::error() {
  catch_up();
  return error_;
}

std::vector<RemovalError> DeviationStage::take_errors() {
  catch_up();
  return std::move(errors_);
}

}  // namespace cuesta
