#pragma once
/// What this process runs on, and what it has used.

#include <cstdint>
#include <string>

namespace cuesta::app {

/// Installed memory, or the control group's limit where that is lower.
std::uint64_t physical_memory_bytes();
/// Largest resident set so far (VmHWM); 0 where the system does not tell.
std::uint64_t peak_resident_bytes();
std::uint64_t resident_bytes();
/// Milliseconds of a steady clock since the program's start.
double clock_ms();
/// "0.1.0"
std::string version_number();
/// Version, commit, compiler and options: the text of --version.
std::string version_text();

}  // namespace cuesta::app
