// consumer [FILE.cuesta]: prints the version it was built with and, given a file, how large its surface is
// and how many triangles a view of it takes.

#include <chrono>
#include <cstdio>

#include "runtime/cut.h"

namespace {

double clock_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

int report(const cuesta::Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return cuesta::exit_status(error.code);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("built with cuesta %s\n", CUESTA_VERSION);
  if (argc < 2) return 0;
  auto file = cuesta::CuestaFile::open(argv[1]);
  if (!file) return report(file.error());
  auto cut = cuesta::Cut::open(std::move(*file), 1ull << 30, clock_ms);
  if (!cut) return report(cut.error());

  cuesta::View view;
  view.eye = {0, 0, 10};
  const auto scale = cuesta::ErrorScale::perspective((*cut)->directory().grid, view);
  cuesta::Budgets budgets;
  budgets.triangles = 500'000;
  const auto done = (*cut)->settle(scale, 1.0, budgets);
  std::printf("%llu of %llu triangles\n", static_cast<unsigned long long>(done.triangles),
              static_cast<unsigned long long>((*cut)->directory().triangles));
  return 0;
}
