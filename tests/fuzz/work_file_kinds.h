#pragma once
/// Which work file an input of fuzz_work_files is: its first byte.

#include <cstdint>

namespace cuesta::fuzz {

enum class WorkFile : std::uint8_t { chunk, survivors, record, bucket_index, soup };

}  // namespace cuesta::fuzz
