#include "terrain/netcdf_header.h"

#include <array>
#include <bit>
#include <string>
#include <string_view>

namespace cuesta {
namespace {

enum Tag : std::uint32_t { absent = 0, dimensions = 10, variables = 11, attributes = 12 };

/// Big-endian numbers; the first that does not fit ends all.
class HeaderWalk {
 public:
  explicit HeaderWalk(std::string_view file) : file_(file), version_(static_cast<unsigned char>(file[3])) {}

  bool run() {
    at_ = 4;
    number(wide());  // records, of which there may be any number
    list(dimensions, [this] {
      name();
      number(wide());
    });
    attribute_list();
    list(variables, [this] {
      name();
      const std::uint64_t rank = count(wide());
      skip(rank * wide());
      attribute_list();
      number(4);                      // type
      number(wide());                 // size
      number(version_ == 1 ? 4 : 8);  // begin
    });
    return good_;
  }
  std::size_t at() const { return at_; }

 private:
  std::size_t wide() const { return version_ == 5 ? 8 : 4; }

  std::uint64_t number(std::size_t bytes) {
    if (!good_ || bytes > file_.size() - at_) {
      good_ = false;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | static_cast<unsigned char>(file_[at_++]);
    return value;
  }
  /// Of elements that take `least` bytes each, at least.
  std::uint64_t count(std::size_t least) {
    const std::uint64_t n = number(wide());
    if (n > (file_.size() - at_) / least) good_ = false;
    return good_ ? n : 0;
  }
  void skip(std::uint64_t bytes) {
    if (bytes > file_.size() - at_)
      good_ = false;
    else
      at_ += bytes;
  }
  void skip_padded(std::uint64_t bytes) { skip((bytes + 3) / 4 * 4); }
  void name() { skip_padded(count(1)); }

  template <class Element>
  void list(Tag tag, Element element) {
    const std::uint64_t found = number(4);
    const std::uint64_t n = count(8);
    if (found != tag && (found != absent || n != 0)) good_ = false;
    for (std::uint64_t i = 0; good_ && i < n; ++i) element();
  }
  void attribute_list() {
    list(attributes, [this] {
      constexpr std::array<std::uint8_t, 12> sizes{0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
      name();
      const std::uint64_t type = number(4);
      if (type == 0 || type >= sizes.size()) good_ = false;
      if (good_) skip_padded(count(sizes[type]) * sizes[type]);
    });
  }

  std::string_view file_;
  unsigned version_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace

Result<void> check_netcdf_header(const RasterFile& file) {
  const std::string_view text = file.text();
  if (text.size() < 4 || !text.starts_with("CDF")) return {};
  HeaderWalk walk(text);
  if (walk.run()) return {};
  return file.error(ErrorCode::corrupt, "byte " + std::to_string(walk.at()),
                    "the netCDF header goes beyond the file: it is damaged or cut off");
}

}  // namespace cuesta
