#include "ooc/part_survey.h"

#include <string_view>

#include "ooc/fingerprint.h"
#include "ooc/read_job.h"

namespace cuesta {
namespace {

template <class T>
std::string_view text_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// A print for each kind of array, as vertices and triangles may come by turns.
class SurveySink : public MeshSink {
 public:
  Result<void> vertices(const VertexBlock& block) override {
    positions_.add(text_of(block.positions));
    attributes_.add(text_of(block.normals));
    attributes_.add(text_of(block.colours));
    attributes_.add(text_of(block.texcoords));
    facts.attributes.normals |= !block.normals.empty();
    facts.attributes.colours |= !block.colours.empty();
    facts.attributes.texcoords |= !block.texcoords.empty();
    return {};
  }
  Result<void> triangles(TriangleBlock block) override {
    triangles_.add(text_of(block));
    return {};
  }
  std::string content() const { return positions_.hex() + attributes_.hex() + triangles_.hex(); }

  PartFacts facts;

 private:
  Fingerprint positions_, attributes_, triangles_;
};

class LoadSink : public MeshSink {
 public:
  explicit LoadSink(const PartFacts& facts) : facts_(facts) {
    mesh.positions.reserve(facts.read.vertices);
    mesh.triangles.reserve(facts.read.triangles);
    if (facts.attributes.normals) mesh.normals.reserve(facts.read.vertices);
    if (facts.attributes.colours) mesh.colours.reserve(facts.read.vertices);
  }
  Result<void> vertices(const VertexBlock& block) override {
    if (block.positions.size() > facts_.read.vertices - mesh.positions.size()) return changed();
    append(mesh.positions, block.positions);
    append(mesh.normals, block.normals);
    append(mesh.colours, block.colours);
    append(mesh.texcoords, block.texcoords);
    return {};
  }
  Result<void> triangles(TriangleBlock block) override {
    if (block.size() > facts_.read.triangles - mesh.triangles.size()) return changed();
    for (const auto& [a, b, c] : block)
      mesh.triangles.push_back(
          {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
    return {};
  }
  static tl::unexpected<Error> changed() {
    return fail(ErrorCode::io, "", "", "a part changed while the scene was read; build it again");
  }

  SurfaceMesh mesh;

 private:
  template <class T>
  static void append(std::vector<T>& all, std::span<const T> block) {
    all.insert(all.end(), block.begin(), block.end());
  }
  const PartFacts& facts_;
};

}  // namespace

Result<PartFacts> survey_part(SceneSource& source, std::uint32_t part) {
  SurveySink sink;
  const auto report = source.read_part(part, sink);
  if (!report) return fail(report.error());
  sink.facts.read = *report;
  sink.facts.content = sink.content();
  return std::move(sink.facts);
}

Result<SurfaceMesh> load_part(SceneSource& source, std::uint32_t part, const PartFacts& facts) {
  LoadSink sink(facts);
  const auto report = source.read_part(part, sink);
  if (!report) return fail(report.error());
  const bool is_same = sink.mesh.positions.size() == facts.read.vertices &&
                       sink.mesh.triangles.size() == facts.read.triangles && is_consistent(sink.mesh);
  if (!is_same) return LoadSink::changed();
  return std::move(sink.mesh);
}

}  // namespace cuesta
