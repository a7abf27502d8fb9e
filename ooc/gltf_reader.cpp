#include "ooc/read_job.h"

namespace cuesta {

Result<ReadReport> read_gltf(const ReadJob& job) {
  return job.error(ErrorCode::unsupported_version, "", "glTF is not read yet; convert it to PLY");
}

}  // namespace cuesta
