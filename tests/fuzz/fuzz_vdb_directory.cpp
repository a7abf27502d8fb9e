/// The grids of a volume, from its header: all that is ours of an OpenVDB file before the library opens it.

#include "ooc/vdb_directory.h"
#include "tests/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cuesta;
  fuzz::BoundedSink sink;
  ReadBudget budget(std::uint64_t{32} << 20);
  const ReadProgress progress;
  const ReadJob job{"fuzz/file", {reinterpret_cast<const char*>(data), size}, sink, budget, progress, {}};
  const auto grids = read_vdb_directory(job);
  if (!grids) {
    if (grids.error().message.empty()) std::abort();
    return 0;
  }
  for (const VdbGrid& g : *grids)
    if (g.topology_byte > g.values_byte || g.values_byte > g.end_byte || g.end_byte > size) std::abort();
  for (const char* name : {"", "density"}) {
    const auto chosen = choose_vdb_grid(job, *grids, name);
    if (chosen ? !chosen->is_scalar() : chosen.error().message.empty()) std::abort();
  }
  return 0;
}
