#include "ooc/map_window.h"

namespace cuesta {

void MapWindow::move_to(const char* at) {
  const auto bytes = file_.bytes();
  file_.release(mark_, at > mark_ ? at : bytes.data() + bytes.size());
  mark_ = at;
}

void MapWindow::release_all() const {
  const auto bytes = file_.bytes();
  file_.release(bytes.data(), bytes.data() + bytes.size());
}

}  // namespace cuesta
