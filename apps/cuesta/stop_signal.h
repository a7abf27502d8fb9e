#pragma once
/// Ctrl-C and SIGTERM as a flag: long work looks at it and ends with ErrorCode::cancelled, tidily.

#include "ooc/result.h"

namespace cuesta::app {

/// From now on the first SIGINT or SIGTERM sets the flag; a second one ends the process at once with the
/// status of `cancelled`, and may leave a file under its temporary name.
void catch_stop_signals();

bool stop_requested();

/// `cancelled` if a stop was requested.
Result<void> check_stop();

}  // namespace cuesta::app
