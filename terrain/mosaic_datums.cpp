#include "terrain/mosaic_datums.h"

#include <fmt/format.h>

#include <algorithm>

#include "ooc/read_job.h"

namespace cuesta {
namespace {

const char* words(VerticalDatum datum) {
  return datum == VerticalDatum::orthometric ? "orthometric (above the geoid)"
                                             : "ellipsoidal (above the ellipsoid)";
}

bool is_known(const RasterInfo& info) {
  return info.vertical_datum != VerticalDatum::unknown;
}

Result<VerticalDatum> datum_of(std::span<const RasterInfo> infos, const MosaicOptions& options) {
  if (options.heights != VerticalDatum::unknown) return options.heights;
  const auto first = std::ranges::find_if(infos, is_known);
  if (first == infos.end()) return VerticalDatum::unknown;
  const auto other = std::ranges::find_if(infos, [&](const RasterInfo& info) {
    return is_known(info) && info.vertical_datum != first->vertical_datum;
  });
  if (other == infos.end()) return first->vertical_datum;
  return fail(
      ErrorCode::invalid_input, other->files.front(), "vertical datum",
      fmt::format("its heights are {}, those of {} {}; name the heights wanted with --heights and a geoid "
                  "with --geoid",
                  words(other->vertical_datum), first->files.front(), words(first->vertical_datum)));
}

}  // namespace

Result<MosaicDatums> choose_datums(std::span<const RasterInfo> infos, std::span<const Crs> systems,
                                   const MosaicOptions& options) {
  const auto datum = datum_of(infos, options);
  if (!datum) return fail(datum.error());
  MosaicDatums out{.datum = *datum, .steps = std::vector<DatumStep>(infos.size(), DatumStep::none)};
  const auto silent = std::ranges::find_if_not(infos, is_known);
  if (silent != infos.end() && *datum != VerticalDatum::unknown)
    out.warnings.push_back(
        fmt::format("{} of {} files, {} among them, do not name their vertical datum; their heights "
                    "are taken as {}",
                    infos.size() - static_cast<std::size_t>(std::ranges::count_if(infos, is_known)),
                    infos.size(), silent->files.front(), words(*datum)));
  for (std::size_t i = 0; i < infos.size(); ++i) {
    if (!is_known(infos[i]) || infos[i].vertical_datum == *datum) continue;
    const auto wrong = [&](const char* why) {
      return fail(ErrorCode::invalid_input, infos[i].files.front(), "vertical datum",
                  fmt::format("its heights are {}, wanted are {} ones; {}", words(infos[i].vertical_datum),
                              words(*datum), why));
    };
    if (!options.geoid) return wrong("name a geoid with --geoid");
    if (systems[i].definition().method == CrsMethod::plane)
      return wrong("where the file lies on the Earth must be known for that");
    out.steps[i] =
        *datum == VerticalDatum::ellipsoidal ? DatumStep::add_undulation : DatumStep::subtract_undulation;
  }
  return out;
}

}  // namespace cuesta
