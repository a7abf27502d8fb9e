#include "apps/serve/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace cuesta::serve {
namespace {

std::string content_type_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 13> types{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".webmanifest", "application/manifest+json"},
      {".wasm", "application/wasm"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
  }};
  for (const auto& [ending, type] : types)
    if (name.ends_with(ending)) return std::string(type);
  return "application/octet-stream";
}

}  // namespace

std::shared_ptr<const Dataset> Contents::dataset(std::string_view name) const {
  const auto at = by_name.find(name);
  return at == by_name.end() ? nullptr : at->second;
}

Catalogue::Catalogue(std::vector<std::filesystem::path> roots, std::filesystem::path page_folder)
    : roots_(std::move(roots)), page_folder_(std::move(page_folder)) {}

std::shared_ptr<const Contents> Catalogue::contents() const {
  const std::lock_guard lock(mutex_);
  return contents_;
}

std::vector<Error> Catalogue::update() {
  auto next = std::make_shared<Contents>();
  bad_before_ = std::exchange(bad_, {});
  told_before_ = std::exchange(told_, {});
  for (const auto& root : roots_) add_root(root, *next);
  add_page_files(*next);
  for (const auto& [name, set] : next->by_name) next->datasets.push_back(set);
  std::sort(next->datasets.begin(), next->datasets.end(),
            [](const auto& a, const auto& b) { return a->name < b->name; });
  next->unreadable = bad_.size();
  const auto before = contents();
  if (next->datasets != before->datasets || next->page_files != before->page_files ||
      next->unreadable != before->unreadable) {
    const std::lock_guard lock(mutex_);
    contents_ = std::move(next);
    generation_.fetch_add(1, std::memory_order_release);
  }
  return std::exchange(news_, {});
}

void Catalogue::add_root(const std::filesystem::path& root, Contents& next) {
  const auto scanned =
      scan_files(root, dataset_suffix, [&](const FoundFile& found) { add_dataset(found, next); });
  if (!scanned) refuse(scanned.error());
}

void Catalogue::add_dataset(const FoundFile& found, Contents& next) {
  if (!found.name.ends_with(dataset_suffix))
    return refuse({ErrorCode::invalid_input, found.name, "", "only names that end in .cuesta are served"});
  const std::string name = found.name.substr(0, found.name.size() - dataset_suffix.size());
  if (next.by_name.contains(name))
    return refuse({ErrorCode::invalid_input, found.name, "", "another file of this name is served"});
  if (const auto known = contents_->dataset(name); known && known->file->stamp == found.stamp) {
    next.by_name.emplace(name, known);
    return;
  }
  if (const auto bad = bad_before_.find(found.name); bad != bad_before_.end() && bad->second == found.stamp) {
    bad_.insert(*bad);
    return;
  }
  auto opened = open_dataset(found);
  if (opened) {
    next.by_name.emplace(name, std::make_shared<const Dataset>(std::move(*opened)));
    return;
  }
  bad_.emplace(found.name, found.stamp);
  news_.push_back(opened.error());
}

void Catalogue::add_page_files(Contents& next) {
  if (page_folder_.empty()) return;
  const auto scanned = scan_files(page_folder_, "", [&](const FoundFile& found) {
    const auto known = contents_->page_files.find(found.name);
    if (known != contents_->page_files.end() && known->second->stamp == found.stamp) {
      next.page_files.insert(*known);
      return;
    }
    Descriptor file = found.open();
    if (!file.is_open()) return;
    const FileStamp& s = found.stamp;
    const std::string tag = fmt::format("{:x}-{:x}-{:x}", s.changed_ns, s.bytes, s.inode);
    next.page_files.emplace(found.name, std::make_shared<const ServedFile>(make_served_file(
                                            std::move(file), s, tag, content_type_of(found.name))));
  });
  if (!scanned) refuse(scanned.error());
}

/// Told once, as long as it stays.
void Catalogue::refuse(Error error) {
  const std::string text = error.text();
  told_.insert(text);
  if (!told_before_.contains(text)) news_.push_back(std::move(error));
}

}  // namespace cuesta::serve
