#include "runtime/draw/pixel_counts.h"

namespace cuesta {

PixelCounts::~PixelCounts() {
  for (const Queries& q : queries_) {
    gl_.DeleteQueries(1, &q.pixels);
    gl_.DeleteQueries(1, &q.fragments);
  }
}

void PixelCounts::begin_picture(int samples) {
  used_ = 0;
  samples_ = static_cast<float>(samples);
}

void PixelCounts::begin() {
  if (used_ == queries_.size()) {
    Queries& made = queries_.emplace_back();
    gl_.GenQueries(1, &made.pixels);
    gl_.GenQueries(1, &made.fragments);
  }
  const Queries& q = queries_[used_++];
  gl_.BeginQuery(GL_SAMPLES_PASSED, q.pixels);
  if (gl_.counts_fragments) gl_.BeginQuery(GL_FRAGMENT_SHADER_INVOCATIONS, q.fragments);
}

void PixelCounts::end() const {
  gl_.EndQuery(GL_SAMPLES_PASSED);
  if (gl_.counts_fragments) gl_.EndQuery(GL_FRAGMENT_SHADER_INVOCATIONS);
}

std::span<const CallFill> PixelCounts::read() {
  const auto count = [this](GLuint query) {
    GLuint value = 0;
    gl_.GetQueryObjectuiv(query, GL_QUERY_RESULT, &value);
    return static_cast<float>(value);
  };
  fill_.clear();
  for (std::size_t i = 0; i < used_; ++i) {
    const float pixels = count(queries_[i].pixels) / samples_;
    fill_.push_back({gl_.counts_fragments ? count(queries_[i].fragments) : pixels, pixels});
  }
  return fill_;
}

}  // namespace cuesta
