#include "ooc/compressed_stream.h"

#include <fmt/format.h>
#include <lzma.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <string>
#include <vector>

#include "ooc/check.h"
#include "ooc/zip_member.h"

namespace cuesta {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 18;
constexpr int widest_window_log = 27;  // what `zstd` itself reads without being asked for more
constexpr int gzip_window_bits = 15 + 16;

tl::unexpected<Error> corrupt_at(std::uint64_t byte, std::string message) {
  return fail(ErrorCode::corrupt, "", fmt::format("byte {}", byte), std::move(message));
}

tl::unexpected<Error> ends_early(std::span<const char> bytes, const char* what) {
  return corrupt_at(bytes.size(), fmt::format("expected the rest of a {} stream, found the end of the file; "
                                              "it was cut off, copy or download it again",
                                              what));
}

bool is_gzip(std::span<const char> bytes) {
  return bytes.size() >= 3 && bytes[0] == '\x1f' && bytes[1] == '\x8b' && bytes[2] == 8;
}

/// Counts what came out, holds it against the limits, passes it on.
class Output {
 public:
  Output(std::span<const char> input, const UnpackLimits& limits, const UnpackSink& sink)
      : input_bytes_(input.size()), limits_(limits), sink_(sink), block_(block_bytes) {}

  char* data() { return block_.data(); }
  Result<void> pass(std::span<const char> block, std::uint64_t bytes_in) {
    total_ += block.size();
    if (auto r = check_ratio(input_bytes_, total_, limits_); !r) return r;
    return sink_(block, bytes_in);
  }
  Result<void> pass(std::size_t count, std::uint64_t bytes_in) {
    return pass({block_.data(), count}, bytes_in);
  }

 private:
  std::uint64_t input_bytes_;
  const UnpackLimits& limits_;
  const UnpackSink& sink_;
  std::vector<char> block_;
  std::uint64_t total_ = 0;
};

struct EndInflate {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

/// zlib counts in 32 bits: input is given piece by piece.
void feed(z_stream& stream, std::span<const char> rest) {
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(rest.size(), std::size_t{1} << 30));
}

Result<void> unpack_gzip(std::span<const char> bytes, Output& out) {
  z_stream stream{};
  if (inflateInit2(&stream, gzip_window_bits) != Z_OK)
    return fail(ErrorCode::out_of_budget, "", "", "the system has no memory left");
  const std::unique_ptr<z_stream, EndInflate> end(&stream);
  for (std::size_t at = 0;;) {
    feed(stream, bytes.subspan(at));
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(block_bytes);
    const uInt given = stream.avail_in;
    const int status = inflate(&stream, Z_NO_FLUSH);
    at += given - stream.avail_in;
    if (auto r = out.pass(block_bytes - stream.avail_out, at); !r) return r;
    if (status == Z_STREAM_END) {
      const auto rest = bytes.subspan(at);
      if (std::all_of(rest.begin(), rest.end(), [](char c) { return c == 0; })) return {};
      if (!is_gzip(rest)) return corrupt_at(at, "expected the end or another gzip member, found other bytes");
      inflateReset(&stream);
    } else if (at == bytes.size() && stream.avail_out > 0) {
      return ends_early(bytes, "gzip");
    } else if (status != Z_OK) {
      return corrupt_at(at, fmt::format("damaged gzip stream: {}", stream.msg ? stream.msg : "bad data"));
    }
  }
}

int window_log_for(std::uint64_t memory_bytes) {
  return std::clamp(static_cast<int>(std::bit_width(memory_bytes)) - 1, 10, widest_window_log);
}

tl::unexpected<Error> zstd_error(std::size_t code, std::uint64_t at, int window_log) {
  switch (ZSTD_getErrorCode(code)) {
    case ZSTD_error_frameParameter_windowTooLarge:
      return fail(
          ErrorCode::out_of_budget, "", fmt::format("byte {}", at),
          fmt::format("the zstd stream needs a window of more than {} KiB to unpack; {}",
                      (1u << window_log) >> 10,
                      window_log < widest_window_log ? "allow more memory"
                                                     : "compress it again without --long or --ultra"));
    case ZSTD_error_memory_allocation:
      return fail(ErrorCode::out_of_budget, "", "", "the system has no memory left");
    default:
      return corrupt_at(at, fmt::format("damaged zstd stream: {}", ZSTD_getErrorName(code)));
  }
}

struct FreeZstd {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

Result<void> unpack_zstd(std::span<const char> bytes, std::uint64_t memory_bytes, Output& out) {
  const std::unique_ptr<ZSTD_DCtx, FreeZstd> context(ZSTD_createDCtx());
  if (!context) return fail(ErrorCode::out_of_budget, "", "", "the system has no memory left");
  const int window_log = window_log_for(memory_bytes);
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, window_log);
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  for (;;) {
    ZSTD_outBuffer block{out.data(), block_bytes, 0};
    const std::size_t hint = ZSTD_decompressStream(context.get(), &block, &in);
    if (ZSTD_isError(hint)) return zstd_error(hint, in.pos, window_log);
    if (auto r = out.pass(block.pos, in.pos); !r) return r;
    if (in.pos < bytes.size()) continue;
    if (hint == 0) return {};  // a frame has ended and all of it is out
    if (block.pos < block_bytes) return ends_early(bytes, "zstd");
  }
}

struct EndXz {
  void operator()(lzma_stream* stream) const { lzma_end(stream); }
};

tl::unexpected<Error> xz_error(lzma_ret status, std::span<const char> bytes, std::uint64_t at) {
  switch (status) {
    case LZMA_MEM_ERROR:
      return fail(ErrorCode::out_of_budget, "", "", "the system has no memory left");
    case LZMA_MEMLIMIT_ERROR:
      return fail(ErrorCode::out_of_budget, "", fmt::format("byte {}", at),
                  "the xz stream needs a larger window to unpack; allow more memory");
    case LZMA_BUF_ERROR:
      return ends_early(bytes, "xz");
    default:
      return corrupt_at(at, "damaged xz stream");
  }
}

Result<void> unpack_xz(std::span<const char> bytes, std::uint64_t memory_bytes, Output& out) {
  lzma_stream stream = LZMA_STREAM_INIT;
  if (lzma_stream_decoder(&stream, memory_bytes, LZMA_CONCATENATED) != LZMA_OK)
    return fail(ErrorCode::out_of_budget, "", "", "the system has no memory left");
  const std::unique_ptr<lzma_stream, EndXz> end(&stream);
  stream.next_in = reinterpret_cast<const std::uint8_t*>(bytes.data());
  stream.avail_in = bytes.size();
  for (;;) {
    stream.next_out = reinterpret_cast<std::uint8_t*>(out.data());
    stream.avail_out = block_bytes;
    const lzma_ret status = lzma_code(&stream, LZMA_FINISH);
    const std::uint64_t at = bytes.size() - stream.avail_in;
    if (auto r = out.pass(block_bytes - stream.avail_out, at); !r) return r;
    if (status == LZMA_STREAM_END) return {};
    if (status != LZMA_OK) return xz_error(status, bytes, at);
  }
}

}  // namespace

Compression compression_of(std::span<const char> bytes) {
  if (is_gzip(bytes)) return Compression::gzip;
  if (is_zip(bytes)) return Compression::zip;
  if (std::string_view(bytes.data(), bytes.size())
          .starts_with(std::string_view("\xfd"
                                        "7zXZ\0",
                                        6)))
    return Compression::xz;
  if (bytes.size() < 4) return Compression::none;
  const std::string_view start(bytes.data(), 4);
  if (start == "\x28\xb5\x2f\xfd") return Compression::zstd;
  const bool skippable = (start[0] & 0xf0) == 0x50 && start.substr(1) == "\x2a\x4d\x18";
  return skippable ? Compression::zstd : Compression::none;
}

std::string_view name(Compression compression) {
  switch (compression) {
    case Compression::gzip:
      return "gzip";
    case Compression::zstd:
      return "zstd";
    case Compression::xz:
      return "xz";
    case Compression::zip:
      return "zip";
    case Compression::none:
      break;
  }
  return "none";
}

Result<void> unpack(std::span<const char> bytes, Compression compression, const UnpackLimits& limits,
                    const UnpackSink& sink) {
  Output out(bytes, limits, sink);
  switch (compression) {
    case Compression::gzip:
      return unpack_gzip(bytes, out);
    case Compression::zstd:
      return unpack_zstd(bytes, limits.memory_bytes, out);
    case Compression::xz:
      return unpack_xz(bytes, limits.memory_bytes, out);
    case Compression::zip:
      return unpack_zip(bytes, [&out](std::span<const char> block, std::uint64_t bytes_in) {
        return out.pass(block, bytes_in);
      });
    case Compression::none:
      break;
  }
  CUESTA_CHECK(compression != Compression::none);
  return {};
}

std::optional<std::uint64_t> declared_size(std::span<const char> bytes, Compression compression) {
  if (compression != Compression::zstd) return std::nullopt;  // gzip's is at the end, modulo 2^32
  const auto size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
  return size;
}

Result<void> check_ratio(std::uint64_t bytes_in, std::uint64_t bytes_out, const UnpackLimits& limits) {
  if (bytes_out <= limits.always_allowed_bytes || bytes_out / limits.most_ratio < bytes_in) return {};
  return fail(ErrorCode::out_of_budget, "", "",
              fmt::format("its {} bytes unpack to {} bytes or more, over {} times as many: no mesh does; "
                          "if it is one, unpack it yourself first",
                          bytes_in, bytes_out, limits.most_ratio));
}

}  // namespace cuesta
