#include "ooc/vdb_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string_view>

namespace cuesta {
namespace {

constexpr std::string_view magic{" BDV\0\0\0\0", 8};
constexpr std::uint32_t oldest_version = 218;  // from here on a file's id is 36 characters
constexpr std::uint32_t newest_version = 224;  // of OpenVDB 10
constexpr std::uint32_t per_grid_compression = 222;
constexpr std::uint32_t file_compression = 220;
constexpr std::string_view half_suffix = "_HalfFloat";
constexpr char name_separator = '\x1e';  // "density", 0x1e, "1" is the second grid of that name

/// Values in file order. What lies beyond the end is zero, and ends the reading: see ok().
class Cursor {
 public:
  explicit Cursor(std::span<const char> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  std::uint64_t at() const { return at_; }
  void go_to(std::uint64_t byte) {
    ok_ = ok_ && byte <= bytes_.size();
    if (ok_) at_ = byte;
  }
  template <class T>
  T value() {
    T v{};
    const std::string_view bytes = take(sizeof(T));
    if (ok_) std::memcpy(&v, bytes.data(), sizeof(T));
    return v;
  }
  std::string_view text() { return take(value<std::uint32_t>()); }
  void skip(std::uint64_t count) { take(count); }

 private:
  std::string_view take(std::uint64_t count) {
    ok_ = ok_ && count <= bytes_.size() - at_;
    if (!ok_) return {};
    const std::string_view taken(bytes_.data() + at_, count);
    at_ += count;
    return taken;
  }

  std::span<const char> bytes_;
  std::uint64_t at_ = 0;
  bool ok_ = true;
};

Result<void> skip_header(const ReadJob& job, Cursor& in) {
  if (!is_vdb(job.bytes)) return job.corrupt_at(0, "expected an OpenVDB file, found something else");
  in.skip(magic.size());
  const auto version = in.value<std::uint32_t>();
  if (in.ok() && (version < oldest_version || version > newest_version))
    return job.error(ErrorCode::unsupported_version, fmt::format("byte {}", magic.size()),
                     fmt::format("OpenVDB file version {}; {} to {} can be read. Save it with OpenVDB 10",
                                 version, oldest_version, newest_version));
  in.skip(8);  // version of the library
  const bool has_offsets = in.value<char>() != 0;
  if (in.ok() && !has_offsets)
    return job.error(ErrorCode::unsupported_version, fmt::format("byte {}", in.at() - 1),
                     "written as a stream, without the places of its grids: save it with openvdb::io::File");
  if (version >= file_compression && version < per_grid_compression) in.skip(1);
  in.skip(36);
  const auto metadata = in.value<std::uint32_t>();
  for (std::uint32_t i = 0; i < metadata && in.ok(); ++i) {
    in.text();  // name
    in.text();  // type
    in.text();  // value
  }
  return {};
}

std::string shown_name(std::string_view unique) {
  const auto separator = unique.find(name_separator);
  if (separator == std::string_view::npos) return std::string(unique);
  return fmt::format("{}[{}]", unique.substr(0, separator), unique.substr(separator + 1));
}

VdbGrid read_entry(Cursor& in) {
  VdbGrid grid;
  grid.name = shown_name(in.text());
  std::string_view type = in.text();
  grid.half = type.ends_with(half_suffix);
  if (grid.half) type.remove_suffix(half_suffix.size());
  grid.type = type;
  in.text();  // the grid whose tree this one shows again
  grid.topology_byte = in.value<std::uint64_t>();
  grid.values_byte = in.value<std::uint64_t>();
  grid.end_byte = in.value<std::uint64_t>();
  return grid;
}

std::string_view base_name(std::string_view name) {
  return name.ends_with(']') ? name.substr(0, name.rfind('[')) : name;
}

/// "density" rather than "density[0]" where that says enough.
std::string list(const std::vector<VdbGrid>& grids) {
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, grids.size()); ++i)
    text += fmt::format("{}{} ({}{})", i ? ", " : "", quote_word(grids[i].name), grids[i].type,
                        grids[i].half ? ", half" : "");
  return grids.size() > most ? fmt::format("{} and {} more", text, grids.size() - most) : text;
}

}  // namespace

bool is_vdb(std::span<const char> bytes) {
  return std::string_view(bytes.data(), bytes.size()).starts_with(magic);
}

Result<std::vector<VdbGrid>> read_vdb_directory(const ReadJob& job) {
  Cursor in(job.bytes);
  CUESTA_TRY(skip_header(job, in));
  const auto count = in.value<std::uint32_t>();
  std::vector<VdbGrid> grids;
  for (std::uint32_t i = 0; i < count && in.ok(); ++i) {
    const VdbGrid grid = read_entry(in);
    if (!in.ok()) break;
    if (grid.topology_byte < in.at() || grid.values_byte < grid.topology_byte ||
        grid.end_byte < grid.values_byte)
      return job.corrupt_at(in.at(), fmt::format("grid {} lies before its own description", i));
    if (grid.end_byte > job.bytes.size())
      return job.corrupt_at(job.bytes.size(),
                            fmt::format("the file is cut short: grid {} ends at byte {}; copy it again",
                                        quote_word(grid.name), grid.end_byte));
    in.go_to(grid.end_byte);
    grids.push_back(grid);
  }
  if (!in.ok()) return job.corrupt_at(job.bytes.size(), "the file is cut short in its header; copy it again");
  if (grids.empty()) return job.corrupt_at(in.at(), "a .vdb file without any grid");
  return grids;
}

Result<VdbGrid> choose_vdb_grid(const ReadJob& job, const std::vector<VdbGrid>& grids,
                                const std::string& name) {
  const auto is_wanted = [&](const VdbGrid& g) { return name.empty() ? g.is_scalar() : g.name == name; };
  auto found = std::find_if(grids.begin(), grids.end(), is_wanted);
  if (found == grids.end() && !name.empty())
    found =
        std::find_if(grids.begin(), grids.end(), [&](const auto& g) { return base_name(g.name) == name; });
  if (found == grids.end() && name.empty())
    return job.error(ErrorCode::invalid_input, "",
                     fmt::format("no grid of scalar float or double values; it has {}", list(grids)));
  if (found == grids.end())
    return job.error(ErrorCode::not_found, "",
                     fmt::format("no grid called {}; it has {}", quote_word(name), list(grids)));
  if (!found->is_scalar())
    return job.error(
        ErrorCode::invalid_input, "",
        fmt::format("grid {} is no Tree_float_5_4_3 or Tree_double_5_4_3, which --grid can name; "
                    "the file has {}",
                    quote_word(found->name), list(grids)));
  return *found;
}

}  // namespace cuesta
