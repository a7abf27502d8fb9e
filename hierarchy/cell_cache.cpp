#include "hierarchy/cell_cache.h"

#include <system_error>
#include <type_traits>

#include "ooc/atomic_file.h"
#include "ooc/byte_arrays.h"
#include "ooc/file_handle.h"
#include "ooc/fingerprint.h"

namespace cuesta {
namespace {

constexpr const char* format_name = "cells 1";

template <class T>
void add_array(Fingerprint& print, const std::vector<T>& values) {
  static_assert(std::has_unique_object_representations_v<T> || std::is_same_v<T, Birth>);
  print.add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

std::vector<std::byte> encode(const SimplifyResult& r) {
  ByteWriter w;
  w.put(r.script.strict_fans);
  w.put(r.passes);
  w.put(static_cast<std::uint8_t>(r.errors_are_estimates));
  put_array(w, r.script.fans);
  put_array(w, r.script.children);
  put_array(w, r.survivors.triangles);
  put_array(w, r.survivors.corners);
  put_array(w, r.survivors.births);
  put_array(w, r.survivors.samples.begin);
  put_array(w, r.survivors.samples.points);
  ByteWriter out;
  out.put(checksum(w.bytes()));
  out.put_bytes(w.bytes());
  return out.take();
}

std::optional<SimplifyResult> decode(std::span<const std::byte> bytes) {
  ByteReader outer(bytes);
  const auto expected = outer.get<std::uint64_t>();
  const auto body = outer.get_bytes(outer.remaining());
  if (!outer.ok() || checksum(body) != expected) return std::nullopt;
  SimplifyResult out;
  ByteReader r(body);
  out.script.strict_fans = r.get<std::uint32_t>();
  out.passes = r.get<std::uint32_t>();
  out.errors_are_estimates = r.get<std::uint8_t>() != 0;
  const bool good = get_array(r, out.script.fans) && get_array(r, out.script.children) &&
                    get_array(r, out.survivors.triangles) && get_array(r, out.survivors.corners) &&
                    get_array(r, out.survivors.births) && get_array(r, out.survivors.samples.begin) &&
                    get_array(r, out.survivors.samples.points) && r.at_end();
  return good ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace

Result<CellCache> CellCache::open(const std::filesystem::path& folder, std::string program) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return fail(ErrorCode::io, folder.string(), "", failed.message());
  auto state = std::make_unique<State>();
  state->folder = folder;
  state->program = std::move(program);
  // The clock of the file system, which is not quite the program's.
  const auto stamp = folder / "used";
  auto file = FileHandle::create(stamp);
  if (!file) return fail(file.error());
  state->opened = std::filesystem::last_write_time(stamp, failed);
  return CellCache(std::move(state));
}

std::string CellCache::key_of(const CellMesh& cell, const SimplifyOptions& options) const {
  Fingerprint print;
  print.add(format_name);
  print.add(state_->program);
  ByteWriter w;
  w.put(options.target_triangles);
  w.put(options.pass_quantile);
  w.put(options.fan_reach);
  if (cell.vertical) {
    const Vertical& v = *cell.vertical;
    for (double x : {v.axis.x, v.axis.y, v.axis.z, v.is_plane ? 1.0 : 0.0, v.centre.x, v.centre.y, v.centre.z,
                     v.stretch})
      w.put(x);
  }
  print.add({reinterpret_cast<const char*>(w.bytes().data()), w.size()});
  add_array(print, cell.positions);
  add_array(print, cell.wedge_group);
  add_array(print, cell.locked);
  add_array(print, cell.triangles);
  add_array(print, cell.births);
  add_array(print, cell.samples.begin);
  add_array(print, cell.samples.points);
  return print.hex();
}

std::optional<SimplifyResult> CellCache::find(const std::filesystem::path& path) const {
  auto file = FileHandle::open(path);
  if (!file) return std::nullopt;
  const auto size = file->size();
  if (!size) return std::nullopt;
  std::vector<std::byte> bytes(*size);
  if (!file->read_at(0, bytes)) return std::nullopt;
  return decode(bytes);
}

SimplifyResult CellCache::simplify(CellMesh cell, const SimplifyOptions& options) {
  const auto path = state_->folder / key_of(cell, options);
  std::error_code ignored;
  if (auto known = find(path)) {
    std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now(), ignored);
    ++state_->found;
    return std::move(*known);
  }
  SimplifyResult result = simplify_cell(std::move(cell), options);
  ++state_->made;
  if (auto file = AtomicFile::create(path); file && file->write(encode(result)))
    static_cast<void>(file->commit());
  return result;
}

void CellCache::remove_unused() {
  std::error_code failed;
  for (std::filesystem::directory_iterator at(state_->folder, failed), end; !failed && at != end;
       at.increment(failed)) {
    std::error_code gone;
    const auto used = at->last_write_time(gone);
    if (!gone && used < state_->opened) std::filesystem::remove(at->path(), gone);
  }
}

}  // namespace cuesta
