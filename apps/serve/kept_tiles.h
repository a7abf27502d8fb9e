#pragma once
/// Files that were made, by name: those asked for longest ago are forgotten.

#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>

namespace cuesta::serve {

/// Threads: one at a time.
class KeptTiles {
 public:
  using Bytes = std::shared_ptr<const std::string>;  // shared with the responses that are made of it

  explicit KeptTiles(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// Null if it is not kept.
  Bytes find(const std::string& name) {
    const auto at = places_.find(name);
    if (at == places_.end()) return nullptr;
    order_.splice(order_.begin(), order_, at->second);
    return at->second->bytes;
  }
  void keep(const std::string& name, Bytes bytes) {
    if (find(name)) return;
    bytes_ += size_of(name, *bytes);
    order_.push_front({name, std::move(bytes)});
    places_.emplace(name, order_.begin());
    while (bytes_ > most_bytes_) {
      bytes_ -= size_of(order_.back().name, *order_.back().bytes);
      places_.erase(order_.back().name);
      order_.pop_back();
    }
  }
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Kept {
    std::string name;
    Bytes bytes;
  };
  static constexpr std::uint64_t entry_bytes = 256;  // of nodes, and of what holds the text
  static std::uint64_t size_of(const std::string& name, const std::string& bytes) {
    return entry_bytes + 2 * name.size() + bytes.size();
  }

  std::uint64_t most_bytes_, bytes_ = 0;
  std::list<Kept> order_;
  std::unordered_map<std::string, std::list<Kept>::iterator> places_;
};

}  // namespace cuesta::serve
