#pragma once
/// What is served now: a list that is never changed, only followed by another one.

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "apps/serve/dataset.h"

namespace cuesta::serve {

struct NameHash {
  using is_transparent = void;
  std::size_t operator()(std::string_view name) const { return std::hash<std::string_view>{}(name); }
};
template <class Value>
using NameMap = std::unordered_map<std::string, std::shared_ptr<const Value>, NameHash, std::equal_to<>>;

/// A moment's contents.
struct Contents {
  std::vector<std::shared_ptr<const Dataset>> datasets;  ///< by name
  NameMap<Dataset> by_name;
  NameMap<ServedFile> page_files;  ///< of the folder with the web page, by name below it
  std::size_t unreadable = 0;      ///< files with the suffix that are not served

  std::shared_ptr<const Dataset> dataset(std::string_view name) const;
};

/// Looks for files, and keeps what it knows of those that have not changed. Threads: one that updates; any
/// that read.
class Catalogue {
 public:
  /// @param roots  .cuesta files, and folders that are searched for them.   @param page_folder  may be empty.
  Catalogue(std::vector<std::filesystem::path> roots, std::filesystem::path page_folder);

  /// Looks again. Where two files have one name the first root's is served.
  /// @return messages of what is not served, that were not there the last time.
  std::vector<Error> update();

  std::shared_ptr<const Contents> contents() const;
  /// Changes with contents(), so that who has looked need not look again.
  std::uint64_t generation() const { return generation_.load(std::memory_order_acquire); }

 private:
  void add_root(const std::filesystem::path& root, Contents& next);
  void add_dataset(const FoundFile& found, Contents& next);
  void add_page_files(Contents& next);
  void refuse(Error error);

  std::vector<std::filesystem::path> roots_;
  std::filesystem::path page_folder_;
  mutable std::mutex mutex_;  // of contents_
  std::shared_ptr<const Contents> contents_ = std::make_shared<Contents>();
  std::atomic<std::uint64_t> generation_{1};
  std::map<std::string, FileStamp> bad_,
      bad_before_;  // files that could not be opened: not tried until they change
  std::set<std::string> told_, told_before_;
  std::vector<Error> news_;
};

}  // namespace cuesta::serve
