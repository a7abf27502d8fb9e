#include "hierarchy/build_scene.h"

#include <algorithm>
#include <mutex>
#include <unordered_map>

#include "hierarchy/encode_part.h"
#include "hierarchy/scene_parts.h"
#include "hierarchy/scene_writer.h"
#include "ooc/ordered_tasks.h"
#include "ooc/part_survey.h"

namespace cuesta {
namespace {

void add(ReadReport& all, const ReadReport& one) {
  all.vertices += one.vertices;
  all.triangles += one.triangles;
  all.polygons_triangulated += one.polygons_triangulated;
  all.faces_out_of_range += one.faces_out_of_range;
  all.faces_too_small += one.faces_too_small;
}

/// A distinct part on its way.
struct Task {
  std::uint32_t source = 0;  ///< number in the source
  PartFacts facts;
};

class SceneBuilder {
 public:
  SceneBuilder(SceneSource& source, const SceneBuildOptions& options, WorkFolder& folder,
               MemoryBudget& memory, const BuildProgress& progress)
      : source_(source), options_(options), folder_(folder), memory_(memory), progress_(progress) {}

  Result<SceneBuildReport> run(const std::filesystem::path& path) {
    if (auto r = survey(); !r) return fail(r.error());
    auto store = SceneParts::open(folder_);
    if (!store) return fail(store.error());
    parts_.emplace(std::move(*store));
    if (auto r = build_toms(); !r) return fail(r.error());
    if (auto r = build_surfaces(); !r) return fail(r.error());
    if (auto r = gather(); !r) return fail(r.error());
    if (auto r = report_progress("write", 0, 1); !r) return fail(r.error());
    const auto written = write_scene(path, directory_, *parts_);
    if (!written) return fail(written.error());
    report_.coarsest_bytes = written->coarsest_bytes;
    report_.file_bytes = written->file_bytes;
    return report_;
  }

 private:
  Result<void> report_progress(std::string_view stage, std::uint64_t done, std::uint64_t total) {
    if (progress_ && !progress_(stage, done, total))
      return fail(ErrorCode::cancelled, "", "", "stopped; the same command goes on from here");
    return {};
  }

  /// Looks at every part that a node shows; equal ones become one.
  Result<void> survey() {
    const std::size_t count = source_.parts().size();
    std::vector<bool> is_shown(count, false);
    for (const SceneNode& node : source_.scene().nodes)
      if (node.part != no_index) is_shown[node.part] = true;
    task_of_.assign(count, no_index);
    std::unordered_map<std::string, std::uint32_t> known;
    for (std::uint32_t part = 0; part < count; ++part) {
      if (auto r = report_progress("survey", part, count); !r) return r;
      if (!is_shown[part]) continue;
      ++report_.parts_read;
      auto facts = survey_part(source_, part);
      if (!facts) return fail(facts.error());
      if (facts->read.triangles == 0) {
        ++report_.parts_empty;
        continue;
      }
      const auto [at, is_new] = known.emplace(facts->content, static_cast<std::uint32_t>(tasks_.size()));
      task_of_[part] = at->second;
      report_.parts_equal += !is_new;
      if (!is_new) continue;
      add(report_.read, facts->read);
      tasks_.push_back({part, std::move(*facts)});
    }
    return {};
  }

  bool is_large(const Task& task) const {
    return task.facts.read.triangles > options_.largest_tom ||
           task.facts.read.vertices > 3 * options_.largest_tom;
  }

  /// What one part in flight takes.
  static std::uint64_t memory_of(const Task& task) {
    return std::max(task.facts.read.triangles, task.facts.read.vertices / 3) * encode_part_bytes_per_triangle;
  }

  Result<void> build_toms() {
    std::vector<std::uint32_t> small;
    std::uint64_t largest = 1, total = 0;
    for (std::uint32_t t = 0; t < tasks_.size(); ++t) {
      if (is_large(tasks_[t])) continue;
      small.push_back(t);
      largest = std::max(largest, memory_of(tasks_[t]));
      total += tasks_[t].facts.read.triangles;
    }
    auto reserved = memory_.reserve_some(largest, arena_threads() + 1, "simplifying a part");
    if (!reserved) return fail(reserved.error());
    std::mutex reading;
    const std::uint64_t finished = parts_->tom_count();
    std::uint64_t done = 0;
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(finished, small.size()); ++i)
      done += tasks_[small[i]].facts.read.triangles;
    return run_in_order<EncodedPart>(
        finished, small.size(), reserved->second,
        [&](std::uint64_t i) { return encode(tasks_[small[i]], reading); },
        [&](std::uint64_t i, EncodedPart part) -> Result<void> {
          if (auto r = parts_->add_tom(part); !r) return r;
          done += tasks_[small[i]].facts.read.triangles;
          return report_progress("simplify", done, total);
        });
  }

  Result<EncodedPart> encode(const Task& task, std::mutex& reading) {
    Result<SurfaceMesh> mesh = [&] {
      const std::lock_guard lock(reading);
      return load_part(source_, task.source, task.facts);
    }();
    if (!mesh) return fail(mesh.error());
    auto part = encode_part(std::move(*mesh), options_.step, options_.make_normals);
    if (!part) return named(part.error(), task);
    return part;
  }

  /// Adds which part it is to an error.
  tl::unexpected<Error> named(Error error, const Task& task) const {
    const std::string place = "part " + std::to_string(task.source) + " " + source_.parts()[task.source];
    if (error.file.empty()) error.file = source_.files().front().string();
    error.place = error.place.empty() ? place : place + ", " + error.place;
    return fail(std::move(error));
  }

  Result<void> build_surfaces() {
    SurfacePartOptions options;
    options.ingest.step = options_.step;
    options.ingest.make_normals = options_.make_normals;
    options.build.cell_triangles = options_.cell_triangles;
    for (std::uint32_t t = 0; t < tasks_.size(); ++t) {
      if (!is_large(tasks_[t])) continue;
      const auto read = [&](RawSurface& sink) -> Result<std::vector<ReadReport>> {
        sink.begin_input();
        auto report = source_.read_part(tasks_[t].source, sink);
        if (!report) return fail(report.error());
        return std::vector<ReadReport>{*report};
      };
      if (auto r = parts_->add_surface(options, read, memory_, progress_); !r)
        return named(r.error(), tasks_[t]);
    }
    return {};
  }

  /// The tables, with parts as they are stored.
  Result<void> gather() {
    directory_.scene = source_.scene();
    std::vector<std::uint32_t> stored(tasks_.size(), no_index);
    std::uint64_t toms = 0, surfaces = 0;
    for (std::uint32_t t = 0; t < tasks_.size(); ++t) {
      StoredPart part = is_large(tasks_[t]) ? parts_->surface(surfaces++) : parts_->tom(toms++);
      report_.clean.add(part.clean);
      if (part.entry.triangles == 0) {
        ++report_.parts_empty;
        continue;
      }
      part.entry.name = source_.parts()[tasks_[t].source];
      stored[t] = static_cast<std::uint32_t>(directory_.parts.size());
      directory_.parts.push_back(std::move(part.entry));
    }
    if (directory_.parts.empty())
      return fail(ErrorCode::invalid_input, source_.files().front().string(), "",
                  "no part of this scene has a triangle");
    for (SceneNode& node : directory_.scene.nodes) {
      if (node.part == no_index) continue;
      const std::uint32_t task = task_of_[node.part];
      if (task != no_index) report_.instanced_read += tasks_[task].facts.read.triangles;
      node.part = task == no_index ? no_index : stored[task];
      if (node.part == no_index) node.material = no_index;
    }
    count();
    directory_.metadata = options_.metadata(report_);
    return {};
  }

  void count() {
    report_.nodes = directory_.scene.nodes.size();
    report_.materials = directory_.scene.materials.size();
    report_.clips = directory_.scene.clips.size();
    for (const ScenePartEntry& part : directory_.parts) {
      ++(part.surface ? report_.surfaces : report_.toms);
      report_.vertices += part.vertices;
      report_.triangles += part.triangles;
    }
    for (const SceneInstance& i : instances_of(directory_.scene)) {
      ++report_.instances;
      report_.instanced_triangles += directory_.parts[i.part].triangles;
    }
  }

  SceneSource& source_;
  const SceneBuildOptions& options_;
  WorkFolder& folder_;
  MemoryBudget& memory_;
  const BuildProgress& progress_;
  std::vector<Task> tasks_;
  std::vector<std::uint32_t> task_of_;  ///< per part of the source; no_index: nothing to show
  std::optional<SceneParts> parts_;
  SceneDirectory directory_;
  SceneBuildReport report_;
};

}  // namespace

Result<SceneBuildReport> build_scene(SceneSource& source, const std::filesystem::path& path,
                                     const SceneBuildOptions& options, WorkFolder& folder,
                                     MemoryBudget& memory, const BuildProgress& progress) {
  return SceneBuilder(source, options, folder, memory, progress).run(path);
}

}  // namespace cuesta
