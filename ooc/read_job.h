#pragma once
/// What every mesh reader is given: the mapped file, where its blocks go, and what it may hold.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "ooc/map_window.h"
#include "ooc/mesh_reader.h"
#include "ooc/result.h"

/// Returns the error of a Result from the enclosing function, if it is one.
#define CUESTA_TRY(expression) \
  if (auto try_result = (expression); !try_result) return ::cuesta::fail(std::move(try_result).error())

namespace cuesta {

/// Counts what a reader holds. Not thread-safe: a reader is one thread.
class ReadBudget {
 public:
  explicit ReadBudget(std::uint64_t limit_bytes) : limit_(limit_bytes) {}

  /// Call before allocating `count` elements of `element_bytes`. @error out_of_budget, nothing is charged.
  Result<void> charge(std::uint64_t count, std::uint64_t element_bytes, const char* what);
  void release(std::uint64_t bytes) { used_ -= bytes; }
  std::uint64_t left() const { return limit_ - used_; }

 private:
  std::uint64_t limit_ = 0;
  std::uint64_t used_ = 0;
};

/// Told the final counts by readers that know them before the first block; a sink in memory can reserve.
using Expect = std::function<Result<void>(std::uint64_t vertices, std::uint64_t triangles)>;

struct ReadJob {
  std::filesystem::path path;
  std::span<const char> bytes;
  MeshSink& sink;
  ReadBudget& budget;
  const ReadProgress& progress;
  Expect expect;
  VolumeOptions volume = {};
  std::filesystem::path temp = {};   ///< folder for what does not fit the budget, as for temp_folder()
  const MappedFile* file = nullptr;  ///< behind `bytes`; none: they are ordinary memory
  MapWindow* window = nullptr;       ///< over `file`

  /// A reader calls it for every row, line or facet, so that what it has read does not stay in memory.
  void passed(const char* at) const {
    if (window) window->passed(at);
  }

  tl::unexpected<Error> error(ErrorCode code, std::string place, std::string message) const {
    return fail(code, path.string(), std::move(place), std::move(message));
  }
  tl::unexpected<Error> corrupt_at(std::uint64_t byte, std::string message) const;
  /// As corrupt_at, with the line number of `position` in a text file.
  tl::unexpected<Error> corrupt_line(const char* position, std::string message) const;
  /// @error cancelled; io if the file was changed meanwhile.
  Result<void> report_progress(std::uint64_t bytes_done) const;
};

/// A word of a file for an error message: in quotes, at most 40 characters, what is not printable as '?'.
std::string quote_word(std::string_view word);

/// Any format, compressed or not: recognises it, calls its reader. Parameters and errors as read_mesh().
Result<ReadReport> read_into(const std::filesystem::path& path, MeshSink& sink, ReadBudget& budget,
                             const ReadProgress& progress, const std::filesystem::path& temp, Expect expect,
                             const VolumeOptions& volume = {});

// One per format; the caller has recognised the format. None throws.
Result<ReadReport> read_ply(const ReadJob& job);
Result<ReadReport> read_obj(const ReadJob& job);
Result<ReadReport> read_stl_ascii(const ReadJob& job);
Result<ReadReport> read_stl_binary(const ReadJob& job);
Result<ReadReport> read_off(const ReadJob& job);
Result<ReadReport> read_gltf(const ReadJob& job);
Result<ReadReport> read_draco(const ReadJob& job);
Result<ReadReport> read_vdb(const ReadJob& job);

}  // namespace cuesta
