#include "terrain/geoid.h"

#include <fmt/format.h>

#include <GeographicLib/Geoid.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <optional>

#include "ooc/check.h"

namespace cuesta {

namespace fs = std::filesystem;

struct Geoid::Data {
  std::string name;
  std::size_t memory_bytes = 0;
  std::unique_ptr<GeographicLib::Geoid> grid;
  std::uintmax_t file_bytes = 0;
  mutable std::mutex mutex;  // for a grid that is not wholly in memory: GeographicLib keeps the last cell

  double value(LatLon at) const {
    if (!(std::abs(at.lat_deg) <= 90) || !std::isfinite(at.lon_deg))
      return std::numeric_limits<double>::quiet_NaN();
    try {
      return (*grid)(at.lat_deg, std::remainder(at.lon_deg, 360));
    } catch (const std::exception&) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  }
};

namespace {

struct Model {
  const char* name;
  std::vector<const char*> data_sets;  // the finest first
};
const std::vector<Model>& models() {
  static const std::vector<Model> all = {{"egm96", {"egm96-5", "egm96-15"}},
                                         {"egm84", {"egm84-15", "egm84-30"}},
                                         {"egm2008", {"egm2008-1", "egm2008-2_5", "egm2008-5"}}};
  return all;
}

/// The data sets that a name may stand for; empty if it is no name of one.
std::vector<std::string> data_sets_of(const std::string& name) {
  for (const Model& model : models()) {
    if (name == model.name) return {model.data_sets.begin(), model.data_sets.end()};
    for (const char* data_set : model.data_sets) {
      if (name == data_set) return {name};
    }
  }
  return {};
}

std::vector<fs::path> default_folders() {
  std::vector<fs::path> folders;
  if (const char* path = std::getenv("GEOGRAPHICLIB_GEOID_PATH")) folders.emplace_back(path);
  if (const char* path = std::getenv("GEOGRAPHICLIB_DATA")) folders.push_back(fs::path(path) / "geoids");
  folders.emplace_back("/usr/share/GeographicLib/geoids");
  folders.emplace_back("/usr/local/share/GeographicLib/geoids");
  return folders;
}

std::optional<fs::path> find_data_set(const std::vector<std::string>& names,
                                      const std::vector<fs::path>& folders) {
  for (const std::string& name : names) {
    for (const fs::path& folder : folders) {
      std::error_code ignored;
      if (fs::is_regular_file(folder / (name + ".pgm"), ignored)) return folder / (name + ".pgm");
    }
  }
  return std::nullopt;
}

std::string how_to_get(const std::vector<std::string>& names, const std::vector<fs::path>& folders) {
  std::string looked;
  for (const fs::path& folder : folders) looked += (looked.empty() ? "" : ", ") + folder.string();
  std::string text = fmt::format(
      "the data set is not installed; looked for {}.pgm in {}; install it with \"geographiclib-get-geoids "
      "{}\" "
      "(package geographiclib-tools)",
      fmt::join(names, ".pgm, "), looked, names.front());
  if (names.front().starts_with("egm96")) {
    text +=
        ", or make it of the grid in package proj-data: \"tools/geoid_from_gtx /usr/share/proj/egm96_15.gtx "
        "egm96-15.pgm\", then --geoid egm96-15.pgm";
  }
  return text;
}

}  // namespace

Geoid::Geoid(std::unique_ptr<Data> data) : data_(std::move(data)) {}
Geoid::Geoid(Geoid&&) noexcept = default;
Geoid& Geoid::operator=(Geoid&&) noexcept = default;
Geoid::~Geoid() = default;

Result<Geoid> Geoid::open(const std::string& name, const GeoidOptions& options) {
  fs::path file = name;
  if (name.find('/') == std::string::npos && file.extension() != ".pgm") {
    const auto names = data_sets_of(name);
    if (names.empty()) {
      return fail(ErrorCode::invalid_input, "", "geoid " + name,
                  "expected egm96, egm84, egm2008, a data set such as egm96-5, or a file .pgm");
    }
    const auto folders = options.folders.empty() ? default_folders() : options.folders;
    const auto found = find_data_set(names, folders);
    if (!found) return fail(ErrorCode::not_found, "", "geoid " + name, how_to_get(names, folders));
    file = *found;
  }
  if (file.extension() != ".pgm") {
    return fail(ErrorCode::invalid_input, name, "",
                "expected a geoid in GeographicLib's format, a file .pgm");
  }
  auto data = std::make_unique<Data>();
  data->name = file.stem().string();
  data->memory_bytes = options.memory_bytes;
  std::error_code error;
  data->file_bytes = fs::file_size(file, error);
  if (error)
    return fail(ErrorCode::not_found, file.string(), "", "the geoid cannot be opened: " + error.message());
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  try {
    // GeographicLib requires that the file is as long as its header says, so its length bounds the memory.
    data->grid = std::make_unique<GeographicLib::Geoid>(data->name, folder, true,
                                                        data->file_bytes <= options.memory_bytes);
  } catch (const std::exception& e) {
    return fail(ErrorCode::corrupt, file.string(), "",
                std::string("not a geoid that can be read: ") + e.what());
  }
  if (!std::isfinite(data->grid->Scale()) || !std::isfinite(data->grid->Offset())) {
    return fail(ErrorCode::corrupt, file.string(), "", "the geoid's scale or offset is not a finite number");
  }
  return Geoid(std::move(data));
}

double Geoid::undulation_m(LatLon at) const {
  if (in_memory()) return data_->value(at);
  const std::lock_guard lock(data_->mutex);
  return data_->value(at);
}

void Geoid::undulations_m(std::span<const LatLon> at, std::span<double> out_m) const {
  CUESTA_CHECK(at.size() == out_m.size(), at.size(), out_m.size());
  std::unique_lock lock(data_->mutex, std::defer_lock);
  if (!in_memory()) lock.lock();
  for (std::size_t i = 0; i < at.size(); ++i) out_m[i] = data_->value(at[i]);
}

Result<void> Geoid::read_area(double south_deg, double west_deg, double north_deg, double east_deg) {
  if (in_memory()) return {};
  const double width_deg = east_deg >= west_deg ? east_deg - west_deg : east_deg - west_deg + 360;
  // As many bytes as the area has in the file, with a border: the stencil's postings, within 3 degrees.
  const double share =
      std::min(1.0, (width_deg + 6) / 360) * std::min(1.0, (north_deg - south_deg + 6) / 180);
  const double bytes = share * static_cast<double>(data_->file_bytes);
  if (!(bytes <= static_cast<double>(data_->memory_bytes))) {
    return fail(
        ErrorCode::out_of_budget, data_->grid->GeoidFile(), "",
        fmt::format("this area of the geoid needs {:.0f} bytes, allowed are {}; use a coarser data set",
                    bytes, data_->memory_bytes));
  }
  const std::lock_guard lock(data_->mutex);
  try {
    data_->grid->CacheArea(south_deg, west_deg, north_deg, west_deg + width_deg);
  } catch (const std::exception& e) {
    return fail(ErrorCode::io, data_->grid->GeoidFile(), "", e.what());
  }
  return {};
}

bool Geoid::in_memory() const {
  return data_->grid->ThreadSafe();
}
const std::string& Geoid::name() const {
  return data_->name;
}
std::string Geoid::description() const {
  return fmt::format("geoid {} ({}), {}", data_->name, data_->grid->Description(), data_->grid->GeoidFile());
}
double Geoid::max_error_m() const {
  const double error_m = data_->grid->MaxError();
  return error_m >= 0 ? error_m : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace cuesta
