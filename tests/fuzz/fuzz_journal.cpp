/// The file of a journal, damaged: an error with words, or a journal that can record more. It may lose what
/// it is told, but finds nothing else in its place.

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "ooc/journal.h"

namespace {

using namespace cuesta;

const std::string& scratch() {
  static const std::string path = "/dev/shm/cuesta-fuzz-" + std::to_string(::getpid());
  return path;
}

void write_scratch(const std::uint8_t* data, std::size_t size) {
  for (const char* of_sqlite : {"-wal", "-shm", "-journal"}) ::unlink((scratch() + of_sqlite).c_str());
  std::FILE* file = std::fopen(scratch().c_str(), "wb");
  if (!file || (size > 0 && std::fwrite(data, size, 1, file) != 1)) std::abort();
  std::fclose(file);
}

template <class T>
bool is_told(const Result<T>& result) {
  return result || !result.error().message.empty();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  write_scratch(data, size);
  auto journal = Journal::open(scratch(), "build");
  if (!is_told(journal)) std::abort();
  if (!journal) return 0;
  for (const char* stage : {"read", "clean"}) {
    if (!is_told(journal->count(stage))) std::abort();
    for (std::uint64_t i = 0; i < 4; ++i)
      if (!is_told(journal->find(stage, i))) std::abort();
  }
  const std::vector<std::byte> result(100, std::byte{7});
  const auto recorded = journal->record("clean", 4, result);
  if (!is_told(recorded)) std::abort();
  if (!recorded) return 0;
  const auto found = journal->find("clean", 4);
  if (found ? *found && **found != result : found.error().message.empty()) std::abort();
  return 0;
}
