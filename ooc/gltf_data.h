#pragma once
/// The bytes behind a glTF document: buffers (in the file, beside it, or as base64), views (also
/// meshopt-compressed), accessors as numbers.

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "ooc/gltf_document.h"
#include "ooc/mapped_file.h"

namespace cuesta::gltf {

/// Numbers of one accessor, checked to lie inside their bytes. A view into Data's memory, cheap to copy.
struct Numbers {
  const char* first = nullptr;
  std::uint64_t stride = 0;
  std::uint64_t count = 0;
  Component component = Component::f32;
  std::uint32_t components = 1;
  bool normalised = false;

  double real(std::uint64_t element, std::uint32_t k) const;
  std::uint64_t index(std::uint64_t element) const;
};

class Data {
 public:
  /// @param binary_chunk  of a GLB; may be empty.
  Data(const ReadJob& job, const Document& document, std::span<const char> binary_chunk)
      : job_(job), document_(document), binary_chunk_(binary_chunk) {}

  /// Loads what is behind the accessor when it is first asked for. @error corrupt, not_found, io,
  /// out_of_budget.
  Result<Numbers> numbers(Id accessor);
  Result<std::span<const char>> view(Id view);
  /// Call when no Numbers and no view are in use any more: frees what was decoded, unless so much memory is
  /// left that keeping it for another primitive costs nothing.
  void forget_decoded();
  /// The bytes from `begin` to `end` have been read: those in files need not stay in memory.
  void release(const char* begin, const char* end) const;
  /// @error io: one of the other files was changed meanwhile.
  Result<void> check_unchanged() const;
  /// Files that were opened so far.
  std::uint64_t other_files() const { return files_.size(); }
  /// All that the document names, read or not; names that would be refused are left out.
  std::vector<std::filesystem::path> paths_of_others() const;

 private:
  Result<std::span<const char>> buffer(Id buffer);
  Result<std::span<const char>> load_buffer(Id buffer);
  Result<std::span<const char>> decode_base64(std::string_view text);
  Result<std::span<const char>> decode_meshopt(const Meshopt& m);
  Result<std::span<const char>> slice(Id buffer, std::uint64_t offset, std::uint64_t bytes);
  Result<Numbers> packed(const Accessor& a, Id view, std::uint64_t offset, std::uint64_t count,
                         Component component, std::uint32_t components, std::uint64_t stride);
  Result<Numbers> materialised(const Accessor& a);
  using Memory = std::vector<std::unique_ptr<std::vector<char>>>;  ///< spans point into them: they never move
  Result<std::vector<char>*> allocate(Memory& memory, std::uint64_t count, std::uint64_t element_bytes,
                                      const char* what);

  const ReadJob& job_;
  const Document& document_;
  std::span<const char> binary_chunk_;
  std::map<Id, std::span<const char>> buffers_;
  std::map<Id, std::span<const char>> meshopt_views_;
  std::map<Id, Numbers> materialised_;
  std::vector<MappedFile> files_;
  Memory base64_;   ///< buffers
  Memory decoded_;  ///< views and accessors
};

}  // namespace cuesta::gltf
