#include "tests/fuzz/fuzz_reader.h"

FUZZ_READER(read_stl_binary)
