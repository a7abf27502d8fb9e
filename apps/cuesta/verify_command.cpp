#include "apps/cuesta/verify_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/cuesta/progress.h"
#include "apps/cuesta/scene_verify.h"
#include "apps/cuesta/text_forms.h"
#include "apps/verify/sample_cuts.h"
#include "hierarchy/verify_file.h"

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;

/// What each check means to somebody who has not read the design.
const char* meaning(Check check) {
  switch (check) {
    case Check::readable:
      return "checksums match, pages decode";
    case Check::directory:
      return "the directory agrees with the pages";
    case Check::sources:
      return "pages of a round hold all that the one before left";
    case Check::crack_free:
      return "cuts have no cracks (I1)";
    case Check::legal:
      return "substitutions keep topology and orientation (I2)";
    case Check::saturated:
      return "errors and spheres contain those they depend on (I3)";
    case Check::honest_error:
      return "reported errors bound measured ones (I5)";
    case Check::count:
      break;
  }
  return "";
}

bool checked(const VerifyReport& report, Check check) {
  return report.cuts > 0 || (check != Check::crack_free && check != Check::honest_error);
}

std::string place(const Finding& f) {
  return f.page == no_page ? std::string("file") : fmt::format("page {} #{}", f.page, f.number);
}

ordered_json json_of(const Finding& f) {
  ordered_json json{{"check", std::string(name(f.check))}};
  if (f.page != no_page) json["page"] = f.page;
  json["number"] = f.number;
  json["text"] = f.text;
  return json;
}

std::string json_text(const VerifySettings& s, const VerifyReport& r) {
  ordered_json json{{"file", s.file.string()},
                    {"ok", r.ok()},
                    {"pages", r.pages},
                    {"fans", r.fans},
                    {"substitutions", r.substitutions},
                    {"topology_let_go", r.topology_let_go},
                    {"sample_cuts", r.cuts},
                    {"least_cosine", r.least_cosine},
                    {"median_bound_ratio", r.median_bound_ratio}};
  for (std::size_t c = 0; c < check_count; ++c) {
    const Check check{static_cast<std::uint8_t>(c)};
    json["violations"][std::string(name(check))] =
        checked(r, check) ? ordered_json(r.found[c]) : ordered_json();
  }
  json["findings"] = ordered_json::array();
  for (const Finding& f : r.findings) json["findings"].push_back(json_of(f));
  json["skipped"] = r.skipped;
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string table(const VerifySettings& s, const VerifyReport& r) {
  std::string text =
      fmt::format("{}: {} pages, {} fans, {} substitutions, {} sample cuts\n", s.file.string(),
                  with_commas(r.pages), with_commas(r.fans), with_commas(r.substitutions), r.cuts);
  for (std::size_t c = 0; c < check_count; ++c) {
    const Check check{static_cast<std::uint8_t>(c)};
    const std::string state = !checked(r, check) ? "not checked"
                              : r.found[c] == 0  ? "ok"
                                                 : with_commas(r.found[c]) + " violations";
    text += fmt::format("  {:<56}{}\n", meaning(check), state);
  }
  if (r.topology_let_go > 0)
    text += fmt::format("  {} substitutions let topology go, where little but handles and holes is left\n",
                        with_commas(r.topology_let_go));
  if (r.median_bound_ratio > 0)
    text +=
        fmt::format("  reported errors are {:.3g} times the measured ones (median)\n", r.median_bound_ratio);
  for (const Finding& f : r.findings) text += fmt::format("{}: {}: {}\n", name(f.check), place(f), f.text);
  if (r.violations() > r.findings.size())
    text += fmt::format("… and {} more\n", with_commas(r.violations() - r.findings.size()));
  for (const std::string& sentence : r.skipped) text += fmt::format("not checked: {}\n", sentence);
  return text;
}

Result<VerifyReport> verify_all(const VerifySettings& s, Progress& progress) {
  const auto file = CuestaFile::open(s.file);
  if (!file) return fail(file.error());
  auto report = verify_file(*file, {}, [&](std::uint64_t done, std::uint64_t total) {
    return progress.update("pages", Unit::pages, done, total);
  });
  if (!report || s.quick) return report;
  if (!report->ok()) {
    report->skipped.push_back("sample cuts (I1, I5): the pages must be right first");
    return report;
  }
  auto cuts = verify::verify_cuts(*file, {}, *report, [&](std::uint64_t done, std::uint64_t total) {
    return progress.update("sample cuts", Unit::none, done, total);
  });
  if (!cuts) return fail(cuts.error());
  return report;
}

}  // namespace

Result<void> run_verify(const VerifySettings& s) {
  const auto kind = ContainerReader::kind_of(s.file);
  if (!kind) return fail(kind.error());
  if (*kind == ContainerKind::scene) return run_scene_verify(s);
  Progress progress(s.quiet);
  const auto report = verify_all(s, progress);
  progress.finish();
  if (!report) return fail(report.error());
  fmt::print("{}", s.json ? json_text(s, *report) : table(s, *report));
  if (report->ok()) return {};
  return fail(ErrorCode::corrupt, s.file.string(), "",
              fmt::format("{} violations were found; build the file again", report->violations()));
}

}  // namespace cuesta::app
