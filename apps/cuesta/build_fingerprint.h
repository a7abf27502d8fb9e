#pragma once
/// What decides the bytes of a build, as one number that the file keeps: a build that would change nothing is
/// not done.

#include <filesystem>
#include <string>

#include "apps/cuesta/build_command.h"
#include "apps/cuesta/progress.h"

namespace cuesta::app {

/// 32 hexadecimal digits: of the program's version and the container's, the options that the metadata lists,
/// and the name and bytes of every input. Not of threads, memory, folders or times (I6).
/// @error of reading an input; cancelled. @cost reads every input once, at the disk's speed; no memory.
Result<std::string> build_fingerprint(const BuildSettings& settings, Progress& progress);

/// True if `file` is a .cuesta file with this fingerprint, and the running program is not newer than it:
/// another build of the same version may do better. Looks at header and directory only: `cuesta verify`
/// checks the pages.
bool is_up_to_date(const std::filesystem::path& file, const std::string& fingerprint);

}  // namespace cuesta::app
