#pragma once
/// Builds small GLB files for tests: JSON text and a binary chunk.

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace cuesta::test {

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

inline std::string glb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  const auto u32 = [](std::size_t v) {
    return bytes_of(std::vector<std::uint32_t>{static_cast<std::uint32_t>(v)});
  };
  return "glTF" + u32(2) + u32(28 + json.size() + binary.size()) + u32(json.size()) + "JSON" + json +
         u32(binary.size()) + std::string("BIN\0", 4) + binary;
}

/// A triangle (0,0,0) (1,0,0) (0,1,0), floats at byte 0, u16 indices 0 1 2 at byte 36.
inline std::string triangle_binary() {
  return bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 0});
}

/// `nodes` and `more` are JSON text; `more` begins with a comma. Mesh 0 is the triangle.
inline std::string triangle_glb(const std::string& nodes, const std::string& more) {
  return glb(
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":44}],"bufferViews":[{"buffer":0,"byteLength":36},
    {"buffer":0,"byteOffset":36,"byteLength":6}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
    {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},
    "indices":1}]}],"nodes":)" +
          nodes + more + "}",
      triangle_binary());
}

}  // namespace cuesta::test
