#include "ooc/scene_source.h"

#include <cctype>
#include <string_view>

#include "ooc/scene_input.h"
#include "ooc/unpacked_file.h"

namespace cuesta {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

Result<SceneInput> SceneInput::open(const std::filesystem::path& path, std::uint64_t memory_bytes,
                                    const std::filesystem::path& temp) {
  auto file = MappedFile::open(path);
  if (!file) return fail(std::move(file).error());
  SceneInput input{path, path, temp, std::move(*file)};
  const Compression compression = compression_of(input.file.bytes());
  if (compression == Compression::none) return input;
  UnpackLimits limits;
  limits.memory_bytes = memory_bytes;
  auto unpacked = unpack_file(path, input.file.bytes(), compression, temp, limits, {});
  if (!unpacked) return fail(std::move(unpacked).error());
  input.inner = name_inside(path);
  CUESTA_TRY(input.file.check_unchanged());
  input.file = std::move(*unpacked);
  return input;
}

Result<void> SceneInput::check_unchanged() const {
  return file.check_unchanged();
}

Result<std::unique_ptr<SceneSource>> open_scene(const std::filesystem::path& path, std::uint64_t memory_bytes,
                                                const std::filesystem::path& temp) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return open_mesh_files(path, memory_bytes, temp);
  auto input = SceneInput::open(path, memory_bytes, temp);
  if (!input) return fail(std::move(input).error());
  const std::string extension = lower_extension(input->inner);
  const std::string_view start(input->file.bytes().data(),
                               std::min<std::size_t>(4, input->file.bytes().size()));
  if (start == "glTF" || extension == ".gltf" || extension == ".glb")
    return open_gltf_scene(std::move(*input), memory_bytes);
  if (extension == ".obj") return open_obj_scene(std::move(*input), memory_bytes);
  return open_mesh_files(path, memory_bytes, temp);
}

}  // namespace cuesta
