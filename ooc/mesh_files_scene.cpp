/// Folders of mesh files as scenes: a part per file, a node per folder; and the scene of a single file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "ooc/scene_input.h"
#include "ooc/unpacked_file.h"

namespace cuesta {
namespace {

constexpr std::array mesh_names{".ply", ".obj", ".stl", ".off", ".gltf", ".glb", ".drc"};
constexpr int deepest_folder = 128;

bool is_mesh_name(const std::filesystem::path& path) {
  std::string extension = name_inside(path.filename()).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(mesh_names.begin(), mesh_names.end(), extension) != mesh_names.end();
}

tl::unexpected<Error> cannot_list(const std::filesystem::path& path, const std::error_code& why) {
  return fail(why == std::errc::no_such_file_or_directory ? ErrorCode::not_found : ErrorCode::io,
              path.string(), "", why.message());
}

/// Passes everything on but texture coordinates, as scenes have no textures.
class WithoutTexcoords : public MeshSink {
 public:
  explicit WithoutTexcoords(MeshSink& sink) : sink_(sink) {}
  Result<void> vertices(const VertexBlock& block) override {
    return sink_.vertices({block.positions, block.normals, block.colours, {}});
  }
  Result<void> triangles(TriangleBlock block) override { return sink_.triangles(block); }

 private:
  MeshSink& sink_;
};

class MeshFilesScene : public SceneSource {
 public:
  MeshFilesScene(std::uint64_t memory_bytes, std::filesystem::path temp)
      : memory_bytes_(memory_bytes), temp_(std::move(temp)) {
    scene_.materials.push_back({"", {255, 255, 255, 255}, 0, 1, false});
  }

  Result<void> add_folder(const std::filesystem::path& path, std::uint32_t parent, int depth = 0) {
    if (depth > deepest_folder)
      return fail(ErrorCode::invalid_input, path.string(), "", "folders nested deeper than 128");
    std::error_code failed;
    std::vector<std::filesystem::directory_entry> entries;
    for (std::filesystem::directory_iterator at(path, failed), end; !failed && at != end;
         at.increment(failed))
      entries.push_back(*at);
    if (failed) return cannot_list(path, failed);
    std::sort(entries.begin(), entries.end());
    for (const auto& entry : entries) {
      std::error_code ignored;
      if (entry.is_directory(ignored) && !entry.is_symlink(ignored)) {
        CUESTA_TRY(add_subfolder(entry.path(), parent, depth));
      } else if (entry.is_regular_file(ignored) && is_mesh_name(entry.path())) {
        add_file(entry.path(), parent);
      }
    }
    return {};
  }

  void add_file(const std::filesystem::path& path, std::uint32_t parent) {
    const auto part = static_cast<std::uint32_t>(parts_.size());
    const std::string name = name_inside(path.filename()).stem().string();
    parts_.push_back(name);
    files_.push_back(path);
    scene_.nodes.push_back({name, parent, part, 0, Trs{}});
  }

  std::vector<std::filesystem::path> files() const override { return files_; }

  Result<ReadReport> read_part(std::uint32_t part, MeshSink& sink) override {
    WithoutTexcoords geometry(sink);
    return read_mesh(files_[part], geometry, memory_bytes_, {}, temp_);
  }

 private:
  /// One without meshes leaves no node.
  Result<void> add_subfolder(const std::filesystem::path& path, std::uint32_t parent, int depth) {
    const auto node = static_cast<std::uint32_t>(scene_.nodes.size());
    scene_.nodes.push_back({path.filename().string(), parent, no_index, no_index, Trs{}});
    CUESTA_TRY(add_folder(path, node, depth + 1));
    if (scene_.nodes.size() == node + 1) scene_.nodes.pop_back();
    return {};
  }

  std::uint64_t memory_bytes_;
  std::filesystem::path temp_;
  std::vector<std::filesystem::path> files_;  ///< of each part
};

}  // namespace

Result<std::unique_ptr<SceneSource>> open_mesh_files(const std::filesystem::path& path,
                                                     std::uint64_t memory_bytes,
                                                     const std::filesystem::path& temp) {
  auto scene = std::make_unique<MeshFilesScene>(memory_bytes, temp);
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored))
    scene->add_file(path, no_index);
  else if (auto r = scene->add_folder(path, no_index); !r)
    return fail(r.error());
  if (scene->parts().empty())
    return fail(ErrorCode::invalid_input, path.string(), "",
                fmt::format("no mesh files in this folder; those named {} are read, also compressed",
                            fmt::join(mesh_names, ", ")));
  return scene;
}

}  // namespace cuesta
