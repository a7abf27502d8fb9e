#include "ooc/spilled_table.h"

#include <algorithm>

namespace cuesta {

Result<void> SpillFile::begin(const char* what) {
  const std::uint64_t places = std::max<std::uint64_t>(1, budget_.left() / 16 / page_bytes_);
  CUESTA_TRY(budget_.charge(1 + places, page_bytes_, what));
  charged_ = (1 + places) * page_bytes_;
  auto file = TempFile::create(temp_);
  if (!file) return fail(std::move(file).error());
  file_ = std::move(*file);
  cache_.emplace([this](std::uint64_t offset, std::span<char> bytes) { return file_->read(offset, bytes); },
                 page_bytes_, places);
  return {};
}

Result<void> SpillFile::append(const char* page) {
  CUESTA_TRY(file_->write({page, page_bytes_}));
  cache_->set_bytes(++pages_ * page_bytes_);
  return {};
}

}  // namespace cuesta
