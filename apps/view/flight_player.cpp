#include "apps/view/flight_player.h"

#include <algorithm>

namespace cuesta::view {

View FlightPlayer::view(double now_s, const View& picture) {
  const double length_s = flight_->keyframes.back().time_s - flight_->keyframes.front().time_s;
  const double at_s = std::min(now_s - *start_s_, length_s);
  if (at_s >= length_s) stop();
  return flight_view(*flight_, at_s, picture);
}

}  // namespace cuesta::view
