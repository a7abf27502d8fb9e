#pragma once
/// A .cuesta file whose pages and directory were changed by hand and sealed again: every checksum is right.

#include <functional>

#include "hierarchy/page_codec.h"
#include "hierarchy/page_positions.h"
#include "tests/hierarchy/built_file.h"

namespace cuesta::test {

struct Contents {
  Directory directory;
  std::vector<Page> pages;
};

inline Contents contents_of(const std::filesystem::path& path) {
  Contents out;
  const auto file = CuestaFile::open(path);
  if (!file) return out;
  out.directory = file->directory();
  PagePositions positions(*file, std::uint64_t{1} << 30);
  for (PageId id = 0; id < out.directory.pages.size(); ++id)
    out.pages.push_back(file->read_page(id, positions.survivors(id).value()).value());
  return out;
}

inline void write_contents(Contents contents, const std::filesystem::path& path) {
  auto writer = ContainerWriter::create(path);
  ASSERT_TRUE(writer);
  for (PageId id = 0; id < contents.pages.size(); ++id) {
    const auto ref = writer->append(encode_page(contents.pages[id]));
    ASSERT_TRUE(ref);
    contents.directory.pages[id].block = *ref;
  }
  ASSERT_TRUE(writer->finish(encode_directory(contents.directory)));
}

}  // namespace cuesta::test
