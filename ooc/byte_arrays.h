#pragma once
/// Arrays of plain elements as bytes: how work files of a build keep them. Same machine, same program: no
/// compression, no versions (a journal of another version is not resumed).

#include <cstring>
#include <vector>

#include "ooc/byte_stream.h"
#include "ooc/vertex_table.h"

namespace cuesta {

template <class T>
void put_array(ByteWriter& w, const std::vector<T>& values) {
  w.put_varint(values.size());
  w.put_bytes(std::as_bytes(std::span(values)));
}

/// False, and an empty array, if the bytes do not hold it.
template <class T>
bool get_array(ByteReader& r, std::vector<T>& values) {
  const std::uint64_t count = r.get_varint();
  values.clear();
  if (!r.ok() || count > r.remaining() / sizeof(T)) return false;
  values.resize(count);
  const auto bytes = r.get_bytes(count * sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return r.ok();
}

inline void put_table(ByteWriter& w, const VertexTable& table) {
  put_array(w, table.positions);
  put_array(w, table.normals);
  put_array(w, table.colours);
  put_array(w, table.texcoords);
}

/// False also if an attribute is neither empty nor as long as the positions.
inline bool get_table(ByteReader& r, VertexTable& table) {
  const auto fits = [&table](std::size_t size) { return size == 0 || size == table.positions.size(); };
  return get_array(r, table.positions) && get_array(r, table.normals) && get_array(r, table.colours) &&
         get_array(r, table.texcoords) && fits(table.normals.size()) && fits(table.colours.size()) &&
         fits(table.texcoords.size());
}

}  // namespace cuesta
