#include "ooc/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ooc/text_cursor.h"

namespace cuesta {
namespace {

constexpr std::uint64_t longest_header = std::uint64_t{1} << 20;

std::optional<PlyType> type_of(std::string_view word) {
  struct Name {
    std::string_view text;
    PlyType type;
  };
  static constexpr std::array<Name, 16> names{{{"char", PlyType::i8},
                                               {"int8", PlyType::i8},
                                               {"uchar", PlyType::u8},
                                               {"uint8", PlyType::u8},
                                               {"short", PlyType::i16},
                                               {"int16", PlyType::i16},
                                               {"ushort", PlyType::u16},
                                               {"uint16", PlyType::u16},
                                               {"int", PlyType::i32},
                                               {"int32", PlyType::i32},
                                               {"uint", PlyType::u32},
                                               {"uint32", PlyType::u32},
                                               {"float", PlyType::f32},
                                               {"float32", PlyType::f32},
                                               {"double", PlyType::f64},
                                               {"float64", PlyType::f64}}};
  for (const Name& name : names) {
    if (name.text == word) return name.type;
  }
  return std::nullopt;
}

class HeaderParser {
 public:
  explicit HeaderParser(const ReadJob& job)
      : job_(job),
        text_{job.bytes.data(),
              job.bytes.data() + std::min<std::uint64_t>(job.bytes.size(), longest_header)} {}

  Result<PlyHeader> parse() {
    if (next_line() != "ply") return job_.corrupt_at(0, "expected \"ply\" on the first line");
    bool has_format = false;
    while (true) {
      if (text_.done())
        return job_.corrupt_line(text_.at, "expected \"end_header\" before the end of the header");
      std::string_view rest = next_line();
      const std::string_view word = take_word(rest);
      if (word == "end_header") break;
      if (word == "format") {
        CUESTA_TRY(format(rest));
        has_format = true;
      } else if (word == "element") {
        CUESTA_TRY(element(rest));
      } else if (word == "property") {
        CUESTA_TRY(property(rest));
      } else if (word != "comment" && word != "obj_info" && !word.empty()) {
        return job_.corrupt_line(text_.at - 1,
                                 fmt::format("expected a PLY header line, found {}", quote_word(word)));
      }
    }
    if (!has_format)
      return job_.corrupt_line(text_.at - 1, "expected a \"format\" line before \"end_header\"");
    header_.data_byte = static_cast<std::uint64_t>(text_.at - job_.bytes.data());
    return std::move(header_);
  }

 private:
  /// Lines end with \n, \r\n or, in files from old systems, \r alone: the first line decides.
  std::string_view next_line() {
    const char* first = text_.at;
    while (!text_.done() && *text_.at != '\n' && *text_.at != '\r') ++text_.at;
    const std::string_view line(first, static_cast<std::size_t>(text_.at - first));
    if (!text_.done() && *text_.at++ == '\r' && !text_.done() && *text_.at == '\n' && !lone_returns_)
      ++text_.at;
    if (first == job_.bytes.data()) lone_returns_ = first != text_.at && text_.at[-1] == '\r';
    return line;
  }

  static std::string_view take_word(std::string_view& rest) {
    TextCursor cursor{rest.data(), rest.data() + rest.size()};
    cursor.skip_blanks();
    const std::string_view word = cursor.word();
    rest = {cursor.at, static_cast<std::size_t>(cursor.end - cursor.at)};
    return word;
  }

  Result<void> format(std::string_view rest) {
    const std::string_view encoding = take_word(rest);
    if (encoding == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (encoding == "binary_little_endian") {
      header_.encoding = PlyEncoding::little_endian;
    } else if (encoding == "binary_big_endian") {
      header_.encoding = PlyEncoding::big_endian;
    } else {
      return job_.corrupt_line(text_.at - 1,
                               "expected ascii, binary_little_endian or binary_big_endian after \"format\"");
    }
    const std::string_view version = take_word(rest);
    if (version == "1.0") return {};
    return job_.error(ErrorCode::unsupported_version, "line 2",
                      fmt::format("PLY version {}; 1.0 can be read", quote_word(version)));
  }

  Result<void> element(std::string_view rest) {
    PlyElement element;
    element.name = take_word(rest);
    const std::string_view number = take_word(rest);
    TextCursor cursor{number.data(), number.data() + number.size()};
    const std::optional<std::int64_t> count = cursor.integer();
    if (element.name.empty() || !count || *count < 0 || !cursor.done()) {
      return job_.corrupt_line(text_.at - 1, "expected a name and a count after \"element\"");
    }
    element.count = static_cast<std::uint64_t>(*count);
    header_.elements.push_back(std::move(element));
    return {};
  }

  Result<void> property(std::string_view rest) {
    if (header_.elements.empty())
      return job_.corrupt_line(text_.at - 1, "a property before the first element");
    PlyProperty property;
    std::string_view type = take_word(rest);
    if (type == "list") {
      const std::optional<PlyType> count = type_of(take_word(rest));
      if (!count || is_real(*count))
        return job_.corrupt_line(text_.at - 1, "expected a whole type for a list's length");
      property.list_count = count;
      type = take_word(rest);
    }
    const std::optional<PlyType> value = type_of(type);
    property.name = take_word(rest);
    if (!value || property.name.empty()) {
      return job_.corrupt_line(text_.at - 1,
                               fmt::format("expected a type and a name, found {}", quote_word(type)));
    }
    property.type = *value;
    header_.elements.back().properties.push_back(std::move(property));
    return {};
  }

  const ReadJob& job_;
  TextCursor text_;
  bool lone_returns_ = false;
  PlyHeader header_;
};

}  // namespace

std::optional<std::uint64_t> PlyElement::row_bytes() const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& p : properties) {
    if (p.list_count) return std::nullopt;
    bytes += ply_bytes(p.type);
  }
  return bytes;
}

std::uint64_t PlyElement::least_row_bytes(bool ascii) const {
  if (ascii) return 2 * properties.size();  // a digit and a separator
  std::uint64_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += ply_bytes(p.list_count ? *p.list_count : p.type);
  return bytes;
}

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

Result<PlyHeader> parse_ply_header(const ReadJob& job) {
  return HeaderParser(job).parse();
}

}  // namespace cuesta
