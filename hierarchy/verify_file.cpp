#include "hierarchy/verify_file.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "hierarchy/page_positions.h"
#include "hierarchy/verify_directory.h"
#include "hierarchy/verify_script.h"
#include "hierarchy/verify_sources.h"

namespace cuesta {
namespace {

class FileCheck {
 public:
  FileCheck(const CuestaFile& file, const VerifyOptions& options)
      : file_(file), sources_(source_pages(file.directory())), positions_(file, options.position_bytes) {
    report_.max_findings = options.max_findings;
  }

  Result<VerifyReport> run(const VerifyProgress& progress) {
    if (!check_directory(file_.directory(), file_.file_bytes(), report_)) return std::move(report_);
    const auto order = finer_first_order(sources_);
    for (PageId id : order) {
      if (progress && !progress(report_.pages, order.size()))
        return fail(ErrorCode::cancelled, file_.path().string(), "", "stopped");
      check_page(id);
      ++report_.pages;
    }
    if (report_.found[static_cast<std::size_t>(Check::readable)] == 0)
      check_vertex_total(file_.directory(), orphans_, report_);
    if (unchecked_ > 0)
      report_.skipped.push_back(
          std::to_string(unchecked_) +
          " pages could not be replayed: they, or pages that they lean on, are unreadable");
    return std::move(report_);
  }

 private:
  void check_page(PageId id) {
    if (const auto page = read(id)) {
      replay(id, *page);
    } else {
      ++unchecked_;
      // It claims nothing, so its sources cannot be called incomplete.
      for (PageId s : sources_[id]) excused_.insert(s);
    }
    release_sources(id);
  }

  std::optional<Page> read(PageId id) {
    const auto survivors = positions_.survivors(id);
    if (!positions_.complaint().empty()) report_.add(Check::sources, id, 0, positions_.complaint());
    if (!survivors) return {};
    auto page = file_.read_page(id, *survivors);
    if (page) return std::move(*page);
    report_.add(Check::readable, id, 0, page.error().text());
    return {};
  }

  void replay(PageId id, const Page& page) {
    std::vector<Birth> births = claim_sources(id, page);
    const auto positions = local_positions(page);
    const PageEntry& entry = file_.directory().pages[id];
    ReplayedSurvivors survivors =
        verify_script(id, page, positions, std::move(births), file_.directory().vertical, report_);
    check_entry(id, entry, page, positions, survivors, report_);
    if (!page.base)
      waiting_[id] = claimable(std::move(survivors), static_cast<std::uint32_t>(entry.coarser.size()));
  }

  /// Births of the page's triangles, from its sources; what has no source is of the original surface.
  std::vector<Birth> claim_sources(PageId id, const Page& page) {
    std::vector<Birth> births(page.triangles.size());
    std::vector<std::uint8_t> removed(page.vertex_count, 0);
    for (const Child& c : page.script.children) removed[c.vertex] = 1;
    orphans_ += page.orphans.size();
    std::vector<PageId> named;
    for (const PageSource& s : page.sources) {
      named.push_back(s.page);
      const auto from = waiting_.find(s.page);
      if (from != waiting_.end()) claim(id, page, s, removed, from->second, births, report_);
    }
    std::sort(named.begin(), named.end());
    if (named != sources_[id])
      report_.add(Check::directory, id, named.size(),
                  "its sources are not the pages that the directory calls finer");
    return births;
  }

  void release_sources(PageId id) {
    for (PageId s : sources_[id]) {
      const auto from = waiting_.find(s);
      if (from == waiting_.end() || --from->second.pages_left > 0) continue;
      if (!excused_.contains(s)) check_claims(s, from->second, report_);
      waiting_.erase(from);
    }
  }

  const CuestaFile& file_;
  VerifyReport report_;
  std::vector<std::vector<PageId>> sources_;
  PagePositions positions_;
  std::unordered_map<PageId, ClaimedSurvivors> waiting_;
  std::unordered_set<PageId> excused_;
  std::uint64_t unchecked_ = 0, orphans_ = 0;
};

}  // namespace

Result<VerifyReport> verify_file(const CuestaFile& file, const VerifyOptions& options,
                                 const VerifyProgress& progress) {
  return FileCheck(file, options).run(progress);
}

}  // namespace cuesta
