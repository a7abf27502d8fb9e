#include "ooc/zip_member.h"

#include <fmt/format.h>
#include <zip.h>

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "ooc/read_job.h"

namespace cuesta {
namespace {

struct CloseZip {
  void operator()(zip_t* zip) const { zip_discard(zip); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using Zip = std::unique_ptr<zip_t, CloseZip>;
using ZipFile = std::unique_ptr<zip_file_t, CloseZip>;

tl::unexpected<Error> corrupt(std::string message) {
  return fail(ErrorCode::corrupt, "", "", std::move(message));
}

/// What an unpacker of Apple's adds, and folders.
bool is_ballast(std::string_view name) {
  return name.ends_with('/') || name.starts_with("__MACOSX/") || name.starts_with('.') ||
         name.find("/.") != name.npos;
}

Result<Zip> open_zip(std::span<const char> bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  Zip zip(source ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr);
  if (!zip && source) zip_source_free(source);
  const std::string text = zip ? "" : zip_error_strerror(&error);
  zip_error_fini(&error);
  if (!zip) return corrupt("not a zip that can be read: " + text);
  return zip;
}

struct Member {
  zip_uint64_t number = 0;
  std::string name;
};

Result<Member> only_member(zip_t* zip) {
  std::optional<Member> found;
  const zip_int64_t count = zip_get_num_entries(zip, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* raw = zip_get_name(zip, static_cast<zip_uint64_t>(i), 0);
    const std::string name = raw ? raw : "";
    if (name.empty() || is_ballast(name)) continue;
    if (found)
      return fail(ErrorCode::invalid_input, "", "",
                  fmt::format("a zip of several files ({} and {}, …); unpack it first",
                              quote_word(found->name), quote_word(name)));
    found.emplace(Member{static_cast<zip_uint64_t>(i), name});
  }
  if (!found) return fail(ErrorCode::invalid_input, "", "", "a zip without a file in it");
  return *found;
}

}  // namespace

bool is_zip(std::span<const char> bytes) {
  const std::string_view start(bytes.data(), std::min<std::size_t>(bytes.size(), 4));
  return start == "PK\x03\x04" || start == "PK\x05\x06";
}

Result<std::string> zip_member_name(std::span<const char> bytes) {
  const auto zip = open_zip(bytes);
  if (!zip) return fail(zip.error());
  auto member = only_member(zip->get());
  if (!member) return fail(std::move(member).error());
  return std::move(member->name);
}

Result<void> unpack_zip(
    std::span<const char> bytes,
    const std::function<Result<void>(std::span<const char> block, std::uint64_t bytes_in)>& sink) {
  const auto zip = open_zip(bytes);
  if (!zip) return fail(zip.error());
  const auto member = only_member(zip->get());
  if (!member) return fail(member.error());
  zip_stat_t facts{};
  const bool is_sized = zip_stat_index(zip->get(), member->number, 0, &facts) == 0 &&
                        (facts.valid & ZIP_STAT_SIZE) != 0 && facts.size > 0;
  const ZipFile file(zip_fopen_index(zip->get(), member->number, 0));
  if (!file) return corrupt(std::string("cannot unpack: ") + zip_strerror(zip->get()));
  std::vector<char> block(std::size_t{1} << 16);
  for (std::uint64_t unpacked = 0;;) {
    const zip_int64_t got = zip_fread(file.get(), block.data(), block.size());
    if (got < 0)
      return fail(ErrorCode::corrupt, "", fmt::format("byte {} of the unpacked file", unpacked),
                  std::string("cannot unpack: ") + zip_file_strerror(file.get()));
    if (got == 0) return {};
    unpacked += static_cast<std::uint64_t>(got);
    const double part = is_sized ? static_cast<double>(unpacked) / static_cast<double>(facts.size) : 0;
    const auto used = static_cast<std::uint64_t>(std::min(1.0, part) * static_cast<double>(bytes.size()));
    CUESTA_TRY(sink({block.data(), static_cast<std::size_t>(got)}, used));
  }
}

}  // namespace cuesta
