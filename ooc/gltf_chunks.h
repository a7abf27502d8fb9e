#pragma once
/// A glTF file, JSON alone or with its binary chunk (GLB), taken apart.

#include <span>

#include "ooc/gltf_document.h"

namespace cuesta::gltf {

struct ParsedFile {
  Document document;
  std::span<const char> binary;  ///< of a GLB, in job.bytes; may be empty
};

/// @error of parse(); corrupt or unsupported_version for the chunks of a GLB
Result<ParsedFile> parse_file(const ReadJob& job);

}  // namespace cuesta::gltf
