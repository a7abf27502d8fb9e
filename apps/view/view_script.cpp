#include "apps/view/view_script.h"

#include <sstream>
#include <utility>

#include "apps/view/view_keys.h"

namespace cuesta::view {

Result<ViewScript> ViewScript::of(const Wanted& wanted) {
  ViewScript script;
  std::istringstream names(wanted.keys);
  for (std::string name; names >> name;) {
    script.keys_.push_back(key_named(name));
    if (script.keys_.back() == Key::unknown)
      return fail(ErrorCode::invalid_input, "", "--press", "there is no key \"" + name + "\"");
  }
  script.flight_ = wanted.flight, script.picture_ = wanted.picture, script.close_ = wanted.close;
  return script;
}

bool ViewScript::busy() const {
  return !keys_.empty() || flight_ || picture_ || close_;
}

ScriptStep ViewScript::next(bool settled) {
  if (!keys_.empty()) {
    key_ = keys_.front();
    keys_.pop_front();
    return ScriptStep::press;
  }
  if (std::exchange(flight_, false)) return ScriptStep::fly;
  if (!settled) return ScriptStep::none;
  if (std::exchange(picture_, false)) return ScriptStep::picture;
  return std::exchange(close_, false) ? ScriptStep::close : ScriptStep::none;
}

}  // namespace cuesta::view
