#pragma once
/// The writers behind write_mesh(), and the buffer that they fill.

#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "ooc/atomic_file.h"
#include "ooc/surface_mesh.h"

namespace cuesta {

/// Gathers small writes into 1 MiB ones. The first error is kept and told by flush().
class BufferedOutput {
 public:
  explicit BufferedOutput(AtomicFile& file) : file_(file) { buffer_.reserve(capacity + 4096); }

  void put(std::string_view text) { put_bytes(text.data(), text.size()); }
  template <class T>
  void put_value(const T& value) {
    put_bytes(&value, sizeof value);
  }
  void put_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    buffer_.insert(buffer_.end(), bytes, bytes + size);
    if (buffer_.size() >= capacity) write_out();
  }
  Result<void> flush() {
    write_out();
    return state_;
  }

 private:
  static constexpr std::size_t capacity = std::size_t{1} << 20;
  void write_out() {
    if (state_) state_ = file_.write(buffer_);
    buffer_.clear();
  }
  AtomicFile& file_;
  std::vector<std::byte> buffer_;
  Result<void> state_;
};

/// Binary, little-endian; positions as float where that loses nothing, else as double.
Result<void> write_ply(BufferedOutput& out, const SurfaceMesh& mesh);
/// Colours as three or, where one is not opaque, four numbers 0…1 after the position.
Result<void> write_obj(BufferedOutput& out, const SurfaceMesh& mesh);
/// @error invalid_input above 4 GiB, the format's limit.
Result<void> write_glb(BufferedOutput& out, const SurfaceMesh& mesh);

}  // namespace cuesta
