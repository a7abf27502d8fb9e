#pragma once
/// Positions of all local vertices of any page: its own, and those of survivors from the coarser pages.

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "hierarchy/cuesta_file.h"

namespace cuesta {

/// Keeps the most recently used pages' positions, at most `budget_bytes` of them and one chain of rounds.
class PagePositions {
 public:
  PagePositions(const CuestaFile& file, std::uint64_t budget_bytes) : file_(file), budget_(budget_bytes) {}

  /// What finer pages need of a page.
  struct Known {
    std::vector<Vec3i> positions;  ///< one per local vertex
    std::vector<PageSource> sources;
  };
  /// @return null when the page, or one that it leans on, cannot be read or leaves a survivor without a
  /// position;
  ///         then complaint() says what is wrong with the page itself, or is empty if it is another page's
  ///         fault.
  std::shared_ptr<const Known> of(PageId id);
  /// As Page::survivors, to read the page with; nothing and complaint() as of().
  std::optional<std::vector<Vec3i>> survivors(PageId id);
  const std::string& complaint() const { return complaint_; }

 private:
  std::shared_ptr<const Known> resolve(PageId id);
  std::optional<std::vector<Vec3i>> find_survivors(PageId id);
  void remember(PageId id, std::shared_ptr<const Known> known);

  struct Entry {
    std::shared_ptr<const Known> known;
    std::list<PageId>::iterator used;
  };
  const CuestaFile& file_;
  std::uint64_t budget_, bytes_ = 0;
  std::list<PageId> order_;  // most recently used first
  std::unordered_map<PageId, Entry> entries_;
  std::string complaint_;
};

}  // namespace cuesta
