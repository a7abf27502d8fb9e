/// STL, both kinds. Every corner is a vertex of its own: welding is the cleaner's work. Facet normals and the
/// two attribute bytes are left out: with them no two facets could share a vertex.

#include <fmt/format.h>

#include <bit>
#include <cctype>
#include <cstring>

#include "ooc/mesh_emitter.h"
#include "ooc/text_cursor.h"

namespace cuesta {
namespace {

static_assert(std::endian::native == std::endian::little, "binary files are read in place");

constexpr std::uint64_t header_bytes = 84;
constexpr std::uint64_t facet_bytes = 50;  ///< normal, three corners, two attribute bytes

bool equal_word(std::string_view word, std::string_view lower_case) {
  return word.size() == lower_case.size() &&
         std::equal(word.begin(), word.end(), lower_case.begin(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

/// The loops of an ascii file: words that carry no geometry are passed over.
class AsciiStl {
 public:
  explicit AsciiStl(const ReadJob& job)
      : job_(job), text_{job.bytes.data(), job.bytes.data() + job.bytes.size()}, out_(job, {}) {}

  Result<ReadReport> read() {
    out_.set_positions([this](std::size_t corner, std::uint64_t) { return loop_[corner]; });
    while (!text_.done()) {
      job_.passed(text_.at);
      text_.skip_spaces();
      const std::string_view word = text_.word();
      if (equal_word(word, "vertex")) {
        CUESTA_TRY(corner());
      } else if (equal_word(word, "endloop")) {
        CUESTA_TRY(end_loop());
      } else if (equal_word(word, "solid") || equal_word(word, "endsolid")) {
        text_.skip_line();  // the rest is a name: it may hold any word
      }
    }
    if (!loop_.empty()) return job_.corrupt_line(text_.at, "the file ends inside a facet");
    return out_.finish();
  }

 private:
  Result<void> corner() {
    Vec3d p;
    for (int axis = 0; axis < 3; ++axis) {
      text_.skip_spaces();
      const std::optional<double> value = text_.real();
      if (!value || !text_.at_word_end())
        return job_.corrupt_line(text_.at, "expected three coordinates of a vertex");
      p[axis] = *value;
    }
    if (loop_.size() >= 1024) return job_.corrupt_line(text_.at, "a facet with more than 1024 corners");
    loop_.push_back(p);
    return {};
  }

  Result<void> end_loop() {
    const std::uint64_t last = first_ + loop_.size();
    out_.set_vertex_count(last);
    out_.at_byte(static_cast<std::uint64_t>(text_.at - job_.bytes.data()));
    corners_.clear();
    for (std::uint64_t i = first_; i < last; ++i) {
      corners_.push_back(i);
      CUESTA_TRY(out_.vertex({.position = loop_[i - first_], .normal = {}, .texcoord = {}}));
    }
    CUESTA_TRY(out_.face(corners_));
    first_ = last;
    loop_.clear();
    return {};
  }

  const ReadJob& job_;
  TextCursor text_;
  MeshEmitter out_;
  std::vector<Vec3d> loop_;
  std::vector<std::uint64_t> corners_;
  std::uint64_t first_ = 0;
};

}  // namespace

Result<ReadReport> read_stl_ascii(const ReadJob& job) {
  return AsciiStl(job).read();
}

Result<ReadReport> read_stl_binary(const ReadJob& job) {
  if (job.bytes.size() < header_bytes) {
    return job.corrupt_at(job.bytes.size(), fmt::format("expected a binary STL header of {} bytes, found {}",
                                                        header_bytes, job.bytes.size()));
  }
  std::uint32_t count = 0;
  std::memcpy(&count, job.bytes.data() + 80, 4);
  const std::uint64_t room = (job.bytes.size() - header_bytes) / facet_bytes;
  if (count > room) {
    return job.corrupt_at(
        80, fmt::format("expected {} triangles of {} bytes, found room for {}", count, facet_bytes, room));
  }
  if (job.expect) CUESTA_TRY(job.expect(std::uint64_t{3} * count, count));
  MeshEmitter out(job, {});
  out.set_vertex_count(std::uint64_t{3} * count);
  for (std::uint64_t t = 0; t < count; ++t) {
    const std::uint64_t byte = header_bytes + t * facet_bytes;
    std::array<float, 9> c;
    std::memcpy(c.data(), job.bytes.data() + byte + 12, sizeof c);
    out.at_byte(byte + facet_bytes);
    job.passed(job.bytes.data() + byte);
    for (std::size_t k = 0; k < 9; k += 3) {
      CUESTA_TRY(out.vertex({.position = {c[k], c[k + 1], c[k + 2]}, .normal = {}, .texcoord = {}}));
    }
    CUESTA_TRY(out.triangle(3 * t, 3 * t + 1, 3 * t + 2));
  }
  return out.finish();
}

}  // namespace cuesta
