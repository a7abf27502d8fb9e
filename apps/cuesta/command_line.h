#pragma once
/// The words of the command line: parses them, runs the command they name.

namespace cuesta::app {

/// @return the process's exit status: 0; 1 for wrong usage; exit_status(code) for what a command ended with.
int run_command_line(int argc, char** argv);

}  // namespace cuesta::app
