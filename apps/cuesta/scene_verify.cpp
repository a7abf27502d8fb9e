#include "apps/cuesta/scene_verify.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/cuesta/progress.h"
#include "apps/cuesta/text_forms.h"
#include "apps/verify/sample_cuts.h"
#include "hierarchy/scene_file.h"
#include "hierarchy/scene_tom.h"
#include "hierarchy/verify_file.h"

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;

/// More are counted only.
constexpr std::size_t most_findings = 20;

struct SceneFindings {
  std::uint64_t toms = 0, surfaces = 0, segments = 0, cuts = 0, violations = 0;
  std::vector<std::string> texts, skipped;

  void add(std::string text) {
    if (texts.size() < most_findings) texts.push_back(std::move(text));
    ++violations;
  }
};

/// The box of the directory holds all vertices, up to the rounding of positions.
bool is_inside(const Tom& tom, const Box3d& box) {
  const double slack = tom.step;
  for (const Vec3f& p : tom.positions) {
    const Vec3d w = tom.origin + vec_cast<double>(p);
    for (int i = 0; i < 3; ++i)
      if (w[i] < box.lo[i] - slack || w[i] > box.hi[i] + slack) return false;
  }
  return true;
}

void check_tom(const SceneFile& file, std::uint32_t part, SceneFindings& found) {
  const ScenePartEntry& entry = file.parts()[part];
  const auto segments = static_cast<std::uint32_t>(entry.segments.size());
  ++found.toms;
  found.segments += segments;
  const auto tom = read_tom(file, part, segments);
  if (!tom) return found.add(tom.error().text());
  if (!is_consistent(*tom)) found.add(fmt::format("part {}: its arrays are not in order", part));
  if (!is_inside(*tom, entry.box)) found.add(fmt::format("part {}: vertices lie outside its box", part));
}

/// Sample cuts are of pages that are right.   @error cancelled
Result<void> check_cuts(const CuestaFile& surface, std::uint32_t part, Progress& progress,
                        VerifyReport& report) {
  if (!report.ok()) {
    report.skipped.push_back("sample cuts (I1, I5): the pages must be right first");
    return {};
  }
  return verify::verify_cuts(surface, {}, report, [&](std::uint64_t done, std::uint64_t total) {
    return progress.update(fmt::format("sample cuts of part {}", part), Unit::none, done, total);
  });
}

Result<void> check_surface(const SceneFile& file, std::uint32_t part, bool quick, Progress& progress,
                           SceneFindings& found) {
  ++found.surfaces;
  const auto surface = file.open_surface(part);
  if (!surface) {
    found.add(surface.error().text());
    return {};
  }
  auto report = verify_file(*surface);
  if (!report) return fail(report.error());
  if (!quick)
    if (auto r = check_cuts(*surface, part, progress, *report); !r) return r;
  found.cuts += report->cuts;
  for (const Finding& f : report->findings)
    found.add(fmt::format("part {}, page {}: {}: {}", part, f.page, name(f.check), f.text));
  found.violations += report->violations() - report->findings.size();
  for (const std::string& text : report->skipped)
    found.skipped.push_back(fmt::format("part {}: {}", part, text));
  return {};
}

Result<SceneFindings> check_all(const SceneFile& file, bool quick, Progress& progress) {
  SceneFindings found;
  const auto count = static_cast<std::uint32_t>(file.parts().size());
  if (!file.is_whole())
    found.add(fmt::format("the file was cut off: {} of {} bytes", file.file_bytes(), file.whole_bytes()));
  for (std::uint32_t part = 0; part < count; ++part) {
    if (!progress.update("parts", Unit::none, part, count))
      return fail(ErrorCode::cancelled, file.path().string(), "", "stopped");
    if (file.parts()[part].is_tom())
      check_tom(file, part, found);
    else if (auto r = check_surface(file, part, quick, progress, found); !r)
      return fail(r.error());
  }
  return found;
}

std::string json_text(const VerifySettings& s, const SceneFindings& f) {
  const ordered_json json{{"file", s.file.string()}, {"kind", "scene"},
                          {"ok", f.violations == 0}, {"toms", f.toms},
                          {"segments", f.segments},  {"surfaces", f.surfaces},
                          {"sample_cuts", f.cuts},   {"violations", f.violations},
                          {"findings", f.texts},     {"skipped", f.skipped}};
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string table(const VerifySettings& s, const SceneFindings& f) {
  std::string text = fmt::format(
      "{}: a scene of {} TOMs in {} segments, and {} fan-hierarchies; {} sample cuts\n", s.file.string(),
      with_commas(f.toms), with_commas(f.segments), with_commas(f.surfaces), with_commas(f.cuts));
  text += fmt::format("  {:<56}{}\n", "checksums match, parts decode and agree with the directory",
                      f.violations == 0 ? "ok" : with_commas(f.violations) + " violations");
  for (const std::string& finding : f.texts) text += finding + "\n";
  for (const std::string& sentence : f.skipped) text += "not checked: " + sentence + "\n";
  return text;
}

}  // namespace

Result<void> run_scene_verify(const VerifySettings& s) {
  Progress progress(s.quiet);
  const auto file = SceneFile::open(s.file);
  if (!file) return fail(file.error());
  const auto found = check_all(*file, s.quick, progress);
  progress.finish();
  if (!found) return fail(found.error());
  fmt::print("{}", s.json ? json_text(s, *found) : table(s, *found));
  if (found->violations == 0) return {};
  return fail(ErrorCode::corrupt, s.file.string(), "",
              fmt::format("{} violations were found; build the file again", found->violations));
}

}  // namespace cuesta::app
