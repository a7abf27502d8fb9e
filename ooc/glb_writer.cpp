#include <nlohmann/json.hpp>

#include "ooc/mesh_formats_out.h"
#include "ooc/srgb.h"

namespace cuesta {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t largest_glb = 0xffff'ffff;
enum ComponentType { u16 = 5123, u32 = 5125, f32 = 5126 };
enum Target { vertex_data = 34962, index_data = 34963 };

/// Adds a view that follows the last one, and an accessor for all of it. Every view is a multiple of four
/// bytes.
std::size_t add_accessor(Json& root, std::uint64_t count, std::uint64_t element_bytes, int component,
                         const char* type, int target, bool normalised = false) {
  Json& views = root["bufferViews"];
  Json& buffer = root["buffers"][0];
  const std::uint64_t offset = buffer["byteLength"].get<std::uint64_t>();
  views.push_back(
      {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", count * element_bytes}, {"target", target}});
  buffer["byteLength"] = offset + count * element_bytes;
  Json accessor{
      {"bufferView", views.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}};
  if (normalised) accessor["normalized"] = true;
  root["accessors"].push_back(std::move(accessor));
  return root["accessors"].size() - 1;
}

Box3d bounds(const SurfaceMesh& mesh) {
  Box3d box;
  for (const Vec3d& p : mesh.positions) box.add(p);
  return box;
}

Json describe(const SurfaceMesh& mesh, Vec3d centre, const Box3d& box) {
  Json root;
  root["asset"] = {{"version", "2.0"}, {"generator", "cuesta"}};
  root["scene"] = 0;
  root["scenes"] = Json::array({{{"nodes", {0}}}});
  root["nodes"] = Json::array({{{"mesh", 0}, {"translation", {centre.x, centre.y, centre.z}}}});
  root["buffers"] = Json::array({{{"byteLength", 0}}});
  root["bufferViews"] = Json::array();
  root["accessors"] = Json::array();
  const std::uint64_t vertices = mesh.positions.size();
  Json attributes;
  const std::size_t position = add_accessor(root, vertices, 12, f32, "VEC3", vertex_data);
  const Vec3f lo = vec_cast<float>(box.lo - centre);
  const Vec3f hi = vec_cast<float>(box.hi - centre);
  root["accessors"][position]["min"] = {lo.x, lo.y, lo.z};
  root["accessors"][position]["max"] = {hi.x, hi.y, hi.z};
  attributes["POSITION"] = position;
  if (!mesh.normals.empty())
    attributes["NORMAL"] = add_accessor(root, vertices, 12, f32, "VEC3", vertex_data);
  if (!mesh.colours.empty())
    attributes["COLOR_0"] = add_accessor(root, vertices, 8, u16, "VEC4", vertex_data, true);
  if (!mesh.texcoords.empty())
    attributes["TEXCOORD_0"] = add_accessor(root, vertices, 8, f32, "VEC2", vertex_data);
  const std::size_t indices = add_accessor(root, 3 * mesh.triangles.size(), 4, u32, "SCALAR", index_data);
  root["meshes"] =
      Json::array({{{"primitives", Json::array({{{"attributes", attributes}, {"indices", indices}}})}}});
  return root;
}

/// 16 bits keep every sRGB byte apart in linear light: the darkest two are 20 steps apart.
std::array<std::uint16_t, 4> linear_colour(const Rgba8& c) {
  std::array<std::uint16_t, 4> out{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double linear = k == 3 ? c[k] / 255.0 : linear_from_srgb(c[k] / 255.0);
    out[k] = static_cast<std::uint16_t>(linear * 65535 + 0.5);
  }
  return out;
}

}  // namespace

Result<void> write_glb(BufferedOutput& out, const SurfaceMesh& mesh) {
  // glTF has no empty accessors: a mesh without triangles is a scene without nodes.
  const bool empty = mesh.positions.empty() || mesh.triangles.empty();
  const Box3d box = bounds(mesh);
  const Vec3d centre = empty ? Vec3d{} : box.lo + (box.hi - box.lo) * 0.5;
  const Json root =
      empty ? Json{{"asset", {{"version", "2.0"}, {"generator", "cuesta"}}}} : describe(mesh, centre, box);
  std::string json = root.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::uint64_t binary = empty ? 0 : root["buffers"][0]["byteLength"].get<std::uint64_t>();
  const std::uint64_t total = 12 + 8 + json.size() + (empty ? 0 : 8 + binary);
  if (total > largest_glb) {
    return fail(ErrorCode::invalid_input, "", "", "a GLB holds at most 4 GiB; write .ply, or a coarser mesh");
  }
  const auto put_u32 = [&out](std::uint64_t value) { out.put_value(static_cast<std::uint32_t>(value)); };
  out.put("glTF");
  put_u32(2);
  put_u32(total);
  put_u32(json.size());
  out.put("JSON");
  out.put(json);
  if (empty) return {};
  put_u32(binary);
  out.put(std::string_view("BIN\0", 4));
  for (const Vec3d& p : mesh.positions) out.put_value(vec_cast<float>(p - centre));
  for (const Vec3f& n : mesh.normals) out.put_value(n);
  for (const Rgba8& c : mesh.colours) out.put_value(linear_colour(c));
  for (const TexCoord& t : mesh.texcoords) out.put_value(TexCoord{t[0], 1 - t[1]});
  for (const auto& t : mesh.triangles) out.put_value(t);
  return {};
}

}  // namespace cuesta
