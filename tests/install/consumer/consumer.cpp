// consumer [FILE.cuesta]: prints the version it was built with and, given a file, how large its surface is.

#include <cstdio>

#include "hierarchy/cuesta_file.h"
#include "runtime/view.h"

int main(int argc, char** argv) {
  std::printf("built with cuesta %s\n", CUESTA_VERSION);
  std::printf("%.0f pixels per unit\n", cuesta::View{}.pixels_per_unit());
  if (argc < 2) return 0;
  const auto file = cuesta::CuestaFile::open(argv[1]);
  if (!file) {
    std::fprintf(stderr, "%s\n", file.error().text().c_str());
    return cuesta::exit_status(file.error().code);
  }
  const cuesta::Directory& directory = file->directory();
  std::printf("%llu triangles in %zu pages\n", static_cast<unsigned long long>(directory.triangles),
              directory.pages.size());
  return 0;
}
