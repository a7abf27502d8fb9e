#include "apps/cuesta/view_command.h"

#include "apps/cuesta/viewer.h"

namespace cuesta::app {

Result<void> run_view(const ViewSettings& settings) {
  auto viewer = Viewer::open(settings);
  if (!viewer) return fail(viewer.error());
  return (*viewer)->run();
}

}  // namespace cuesta::app
