#include "apps/cuesta/view_subject.h"

#include "ooc/container_file.h"

namespace cuesta::app {

Result<std::unique_ptr<ViewSubject>> open_subject(const ViewSettings& settings,
                                                  const std::vector<std::filesystem::path>& files,
                                                  view::CameraControls& controls) {
  for (const auto& file : files) {
    const auto kind = ContainerReader::kind_of(file);
    if (!kind) return fail(kind.error());
    if (*kind != ContainerKind::scene) continue;
    if (files.size() == 1) return open_scene_subject(settings, file, controls);
    return fail(ErrorCode::invalid_input, file.string(), "",
                "a scene is shown by itself, without other files");
  }
  return open_surface_subject(settings, files, controls);
}

}  // namespace cuesta::app
