#pragma once
/// What cells became, kept from one build to the next: a cell that is the same again is not simplified again.
/// So a change of the input costs what it touches, and the result is what a build without this gives.

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hierarchy/simplify_cell.h"
#include "ooc/result.h"

namespace cuesta {

/// A folder with a file for each cell, named by a hash of 128 bits of the cell and the options. What is
/// missing or damaged is made anew; what cannot be written is left out. Threads: calls are concurrent.
class CellCache {
 public:
  /// Opens or makes the folder. @param program  tells apart programs that would make something else of a cell
  static Result<CellCache> open(const std::filesystem::path& folder, std::string program);

  /// simplify_cell(), or what it gave before.
  SimplifyResult simplify(CellMesh cell, const SimplifyOptions& options);

  /// Removes what neither was found nor made since open().
  void remove_unused();
  std::uint64_t found() const { return state_->found; }
  std::uint64_t made() const { return state_->made; }

 private:
  struct State {
    std::filesystem::path folder;
    std::string program;
    std::atomic<std::uint64_t> found{0}, made{0};
    std::filesystem::file_time_type opened;
  };
  explicit CellCache(std::unique_ptr<State> state) : state_(std::move(state)) {}
  std::string key_of(const CellMesh& cell, const SimplifyOptions& options) const;
  std::optional<SimplifyResult> find(const std::filesystem::path& path) const;

  std::unique_ptr<State> state_;
};

}  // namespace cuesta
