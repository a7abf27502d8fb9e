#include "runtime/draw/pixel_counts.h"

namespace cuesta {

PixelCounts::~PixelCounts() {
  if (!queries_.empty()) gl_.DeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

void PixelCounts::begin_picture(int samples) {
  used_ = 0;
  samples_ = static_cast<float>(samples);
}

void PixelCounts::begin() {
  if (used_ == queries_.size()) gl_.GenQueries(1, &queries_.emplace_back());
  gl_.BeginQuery(GL_SAMPLES_PASSED, queries_[used_++]);
}

std::span<const float> PixelCounts::read() {
  pixels_.clear();
  for (std::size_t i = 0; i < used_; ++i) {
    GLuint samples = 0;
    gl_.GetQueryObjectuiv(queries_[i], GL_QUERY_RESULT, &samples);
    pixels_.push_back(static_cast<float>(samples) / samples_);
  }
  return pixels_;
}

}  // namespace cuesta
