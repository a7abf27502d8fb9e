#pragma once
/// What a viewer is told to do by its command line: keys, then a flight, then a picture once all has settled,
/// then the end.

#include <deque>
#include <string>

#include "ooc/result.h"
#include "runtime/draw/window.h"

namespace cuesta::view {

enum class ScriptStep : std::uint8_t { none, press, fly, picture, close };

class ViewScript {
 public:
  struct Wanted {
    std::string keys;  ///< names, with blanks between
    bool flight = false, picture = false, close = false;
  };
  /// @error invalid_input: a name that no key has
  static Result<ViewScript> of(const Wanted& wanted);

  /// False when nothing is left to do.
  bool busy() const;
  /// The next step, which is done then.
  /// @param settled  the picture shows all that it will, and no flight is played
  ScriptStep next(bool settled);
  /// Of the step `press` that came last.
  Key key() const { return key_; }

 private:
  std::deque<Key> keys_;
  Key key_ = Key::unknown;
  bool flight_ = false, picture_ = false, close_ = false;
};

}  // namespace cuesta::view
