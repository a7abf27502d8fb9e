// fly FILE.cuesta: flies once around a model and keeps its own copy of what is drawn, as a graphics card
// would.
#include <chrono>
#include <cmath>
#include <cstdio>

#include "runtime/cut.h"

using namespace cuesta;

static double clock_ms() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

static int report(const Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return exit_status(error.code);
}

int main(int argc, char** argv) {
  std::printf("built with cuesta %s\n", CUESTA_VERSION);
  if (argc < 2) return 0;
  auto file = CuestaFile::open(argv[1]);
  if (!file) return report(file.error());
  // 256 MiB of pages, read and decoded by one thread beside this one; the runtime has no clock of its own.
  auto opened = Cut::open(std::move(*file), 256u << 20, clock_ms, 1);
  if (!opened) return report(opened.error());
  Cut& cut = **opened;
  cut.set_geomorph_ms(250);

  Budgets budgets;  // of each frame; what is left undone goes on in the next
  budgets.adapt_ms = 4;
  budgets.triangles = 1'000'000;
  budgets.upload_bytes = 4 << 20;

  const Directory& d = cut.directory();
  const Vec3d lo = d.grid.world(d.lo), hi = d.grid.world(d.hi), centre = (lo + hi) / 2.0;
  std::vector<DrawVertex> vertices;  // the card's copies of the pools
  std::vector<std::uint32_t> indices;
  View view;  // 1280 x 720 pixels, 60 degrees
  view.target = centre;
  AdaptReport done;
  for (int frame = 0; frame < 120; ++frame) {
    const double angle = frame * 2 * 3.14159265358979 / 120;
    view.eye = centre + Vec3d{std::sin(angle), 0.3, std::cos(angle)} * length(hi - lo);
    const ErrorScale scale = ErrorScale::perspective(d.grid, view, 4);
    done = cut.adapt(scale, 1.0, budgets);       // 1 pixel; never waits for the disk
    const DrawList list = cut.draw_list(scale);  // without the pages that cannot be seen
    vertices.resize(list.vertices.size());
    indices.resize(list.indices.size());
    for (const Range& r : list.changed_vertices)
      std::copy_n(list.vertices.begin() + r.first, r.count, vertices.begin() + r.first);
    for (const MorphedVertex& m : list.morphed) vertices[m.slot] = m.vertex;
    for (const Range& r : list.changed_indices)
      std::copy_n(list.indices.begin() + r.first, r.count, indices.begin() + r.first);
    for (const Range& r : list.draws) (void)r;  // glMultiDrawElements(r.count indices from r.first)
  }
  for (const Error& error : cut.cache().errors())
    report(error);  // pages drawn coarser, for they cannot be read
  std::printf("%llu of %llu triangles, error %.2f px, %.2f ms\n",
              static_cast<unsigned long long>(done.triangles), static_cast<unsigned long long>(d.triangles),
              done.achieved, done.adapt_ms);
}
