#pragma once
/// Bytes as an open raster file that is on no disk: for tests and fuzz targets that open many.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>

#include "terrain/raster_readers.h"

namespace cuesta::test {

/// @param name  as which it is recognised and placed, "N01E001.hgt". Aborts where memory is out.
inline RasterFile memory_file(const std::string& name, std::string_view bytes) {
  const int descriptor = ::memfd_create("raster", MFD_CLOEXEC);
  if (descriptor < 0) std::abort();
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t more = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (more <= 0) std::abort();
    done += static_cast<std::size_t>(more);
  }
  auto map = MappedFile::map(descriptor, name);
  ::close(descriptor);
  if (!map) std::abort();
  return {name, name, true, std::move(*map)};
}

}  // namespace cuesta::test
