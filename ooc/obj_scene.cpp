/// OBJ scenes: a part per object ("o"), or per group ("g") of a file without objects, each shown once.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <unordered_map>

#include "ooc/local_name.h"
#include "ooc/material_library.h"
#include "ooc/obj_data.h"
#include "ooc/scene_input.h"

namespace cuesta {
namespace {

/// Lines that follow each other, with faces of one part among them.
struct FaceRun {
  std::uint64_t begin = 0, end = 0;   ///< bytes of the file
  ObjSeen seen;                       ///< above its first line
  std::uint32_t material = no_index;  ///< in use at its first line
};

class ObjScene : public SceneSource {
 public:
  ObjScene(SceneInput input, std::uint64_t memory_bytes)
      : input_(std::move(input)),
        budget_(memory_bytes),
        window_(input_.file),
        job_(job_for(no_sink_)),
        data_(job_) {}

  Result<void> open() {
    CUESTA_TRY(scan());
    drop_empty_parts();
    make_nodes();
    if (textured_ > 0)
      warnings_.push_back(fmt::format("{} materials have textures, which are not kept", textured_));
    return input_.check_unchanged();
  }

  std::vector<std::filesystem::path> files() const override { return files_; }

  Result<ReadReport> read_part(std::uint32_t part, MeshSink& sink) override {
    const ReadJob job = job_for(sink);
    const Part& p = found_[part];
    const bool is_tinted = p.is_mixed || !data_.colours.empty();
    MeshEmitter out(job, {.normals = !data_.normals.empty(), .colours = is_tinted});
    ObjFaces faces(job, data_, out, ObjFaces::Vertices::corners);
    for (const FaceRun& run : p.runs) CUESTA_TRY(emit(run, p, faces));
    auto report = out.finish();
    CUESTA_TRY(input_.check_unchanged());
    return report;
  }

 private:
  struct Part {
    std::string name;
    std::vector<FaceRun> runs;
    std::uint32_t material = no_index;  ///< of its first face
    bool has_faces = false, is_mixed = false;
  };

  ReadJob job_for(MeshSink& sink) {
    ReadJob job{input_.path, input_.file.bytes(), sink, budget_, no_progress_, {}};
    job.temp = input_.temp;
    job.file = &input_.file;
    job.window = &window_;
    return job;
  }

  /// Vertex data into the tables; where the faces of each part are.
  Result<void> scan() {
    ObjStatements statements(input_.file.bytes());
    TextCursor line;
    for (const char* first = statements.at(); statements.next(line); first = statements.at()) {
      const ObjKeyword word = obj_keyword(line);
      seen_.count(word);
      CUESTA_TRY(data_.add(word, line));
      if (word == ObjKeyword::o) CUESTA_TRY(begin_part(std::string(obj_rest(line)), true));
      if (word == ObjKeyword::g) CUESTA_TRY(begin_part(std::string(obj_rest(line)), false));
      if (word == ObjKeyword::usemtl) material_ = material_named(std::string(obj_rest(line)));
      if (word == ObjKeyword::mtllib) read_library(std::string(obj_rest(line)));
      if (word == ObjKeyword::f) CUESTA_TRY(add_face(byte(first), byte(statements.at())));
      job_.passed(statements.at());
    }
    return {};
  }
  std::uint64_t byte(const char* at) const {
    return static_cast<std::uint64_t>(at - input_.file.bytes().data());
  }

  /// Groups of one name are one part, wherever their faces are; objects are not. Once there is an object,
  /// groups are no parts.
  Result<void> begin_part(std::string name, bool is_object) {
    if (!is_object && has_objects_) return {};
    has_objects_ |= is_object;
    const auto known = is_object ? groups_.end() : groups_.find(name);
    current_ = known == groups_.end() ? found_.size() : known->second;
    if (known != groups_.end()) return {};
    CUESTA_TRY(job_.budget.charge(2, sizeof(Part) + name.size(), "parts"));
    if (!is_object) groups_.emplace(name, current_);
    found_.push_back({std::move(name), {}});
    return {};
  }

  Result<void> add_face(std::uint64_t begin, std::uint64_t end) {
    if (current_ == found_.size()) found_.push_back({});
    Part& part = found_[current_];
    const std::uint32_t material = material_ == no_index ? material_ = material_named("") : material_;
    if (!part.has_faces) part.material = material;
    part.has_faces = true;
    part.is_mixed |= part.material != material;
    // Between the faces of a run may be lines of vertices, of which there can be many: not of this part's
    // faces.
    constexpr std::uint64_t longest_gap = 4096;
    if (part.runs.empty() || begin - part.runs.back().end > longest_gap || last_part_ != current_) {
      CUESTA_TRY(job_.budget.charge(2, sizeof(FaceRun), "runs of faces"));
      part.runs.push_back({begin, end, seen_, material});
    }
    part.runs.back().end = end;
    last_part_ = current_;
    return {};
  }

  std::uint32_t material_named(const std::string& name) {
    const auto [at, is_new] =
        material_numbers_.emplace(name, static_cast<std::uint32_t>(scene_.materials.size()));
    if (is_new) scene_.materials.push_back({name, {255, 255, 255, 255}, 0, 1, false});
    return at->second;
  }

  /// One that cannot be read leaves its materials white.
  void read_library(const std::string& name) {
    const std::filesystem::path path = input_.path.parent_path() / name;
    if (!is_local_name(name)) {
      warnings_.push_back("not read: " + quote_word(name) + ", which is not in the scene's folder");
      return;
    }
    const auto library = read_material_library(path);
    if (!library) {
      warnings_.push_back("materials are white: " + library.error().text());
      return;
    }
    files_.push_back(path);
    textured_ += library->textured;
    for (const SceneMaterial& m : library->materials) scene_.materials[material_named(m.name)] = m;
  }

  void drop_empty_parts() {
    std::erase_if(found_, [](const Part& p) { return !p.has_faces; });
  }

  std::uint32_t mixed_material(const Part& part) {
    if (!part.is_mixed) return part.material;
    if (mixed_ == no_index) {
      mixed_ = static_cast<std::uint32_t>(scene_.materials.size());
      scene_.materials.push_back({"vertex colours", {255, 255, 255, 255}, 0, 1, false});
    }
    return mixed_;
  }

  void make_nodes() {
    for (const Part& part : found_) {
      const auto number = static_cast<std::uint32_t>(parts_.size());
      parts_.push_back(part.name);
      scene_.nodes.push_back({part.name, no_index, number, mixed_material(part), Trs{}});
    }
  }

  Result<void> emit(const FaceRun& run, const Part& part, ObjFaces& faces) {
    ObjStatements statements(input_.file.bytes().subspan(run.begin, run.end - run.begin));
    TextCursor line;
    ObjSeen seen = run.seen;
    set_colour(faces, part, run.material);
    while (statements.next(line)) {
      const ObjKeyword word = obj_keyword(line);
      seen.count(word);
      if (word == ObjKeyword::usemtl)
        set_colour(faces, part, material_numbers_.at(std::string(obj_rest(line))));
      if (word == ObjKeyword::f) CUESTA_TRY(faces.face(line, seen));
      job_.passed(statements.at());
    }
    return {};
  }
  /// One number for all where the material decides about the colour.
  void set_colour(ObjFaces& faces, const Part& part, std::uint32_t material) const {
    faces.set_colour(part.is_mixed ? material : 0, scene_.materials[material].base_colour);
  }

  SceneInput input_;
  ReadBudget budget_;
  NoSink no_sink_;
  ReadProgress no_progress_;
  MapWindow window_;
  ReadJob job_;
  ObjData data_;
  std::vector<std::filesystem::path> files_{input_.path};
  std::vector<Part> found_;
  std::unordered_map<std::string, std::size_t> groups_;
  std::unordered_map<std::string, std::uint32_t> material_numbers_;
  std::size_t current_ = 0, last_part_ = 0;
  std::uint32_t material_ = no_index, mixed_ = no_index;
  std::uint64_t textured_ = 0;
  bool has_objects_ = false;
  ObjSeen seen_;
};

}  // namespace

Result<std::unique_ptr<SceneSource>> open_obj_scene(SceneInput input, std::uint64_t memory_bytes) {
  auto scene = std::make_unique<ObjScene>(std::move(input), memory_bytes);
  CUESTA_TRY(scene->open());
  return scene;
}

}  // namespace cuesta
