/// cuesta: gigantic meshes into one file that can be flown through. The commands are in command_line.cpp.

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "apps/cuesta/command_line.h"
#include "apps/cuesta/huge_pages.h"
#include "apps/cuesta/stop_signal.h"
#include "ooc/result.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "build") cuesta::app::use_huge_pages(argv);
  cuesta::app::catch_stop_signals();
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of write(), with a message
  try {
    return cuesta::app::run_command_line(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("cuesta: memory ran out; close other programs, or lower --memory or --cache (out of budget)\n",
               stderr);
    return cuesta::exit_status(cuesta::ErrorCode::out_of_budget);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "cuesta: %s (input/output error)\n", e.what());
    return cuesta::exit_status(cuesta::ErrorCode::io);
  }
}
