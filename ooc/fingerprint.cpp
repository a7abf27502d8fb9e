#include "ooc/fingerprint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <vector>

namespace cuesta {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 18;

tl::unexpected<Error> os_error(const std::filesystem::path& path, const char* what) {
  return fail(errno == ENOENT || errno == ENOTDIR ? ErrorCode::not_found : ErrorCode::io, path.string(), "",
              fmt::format("{}: {}", what, std::strerror(errno)));
}

/// Closes on the way out.
struct Descriptor {
  int number;
  explicit Descriptor(int open) : number(open) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

}  // namespace

struct Fingerprint::State {
  XXH3_state_t* hash = XXH3_createState();
  State() {
    if (!hash) throw std::bad_alloc();
    XXH3_128bits_reset(hash);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { XXH3_freeState(hash); }
};

Fingerprint::Fingerprint() : state_(std::make_unique<State>()) {}
Fingerprint::~Fingerprint() = default;

void Fingerprint::add(std::string_view text) {
  add_bytes(text);
  end_item(text.size());
}

Result<void> Fingerprint::add_file(const std::filesystem::path& path, const FingerprintProgress& progress) {
  // O_NONBLOCK: opening a named pipe must not wait for a writer.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.number < 0) return os_error(path, "cannot open");
  struct stat info {};
  if (::fstat(file.number, &info) != 0 || !S_ISREG(info.st_mode))
    return fail(ErrorCode::io, path.string(), "", "expected a regular file");
  ::posix_fadvise(file.number, 0, 0, POSIX_FADV_SEQUENTIAL);
  std::vector<char> block(block_bytes);
  std::uint64_t done = 0;
  for (;;) {
    const ssize_t n = ::read(file.number, block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return os_error(path, "cannot read");
    if (n == 0) break;
    add_bytes({block.data(), static_cast<std::size_t>(n)});
    done += static_cast<std::uint64_t>(n);
    if (progress && !progress(done))
      return fail(ErrorCode::cancelled, path.string(), "", "reading was cancelled");
  }
  end_item(done);
  return {};
}

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::string Fingerprint::hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->hash);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

void Fingerprint::add_bytes(std::span<const char> bytes) {
  XXH3_128bits_update(state_->hash, bytes.data(), bytes.size());
}

void Fingerprint::end_item(std::uint64_t bytes) {
  std::array<char, 8> length{};
  for (char& byte : length) {
    byte = static_cast<char>(bytes & 0xff);
    bytes >>= 8;
  }
  add_bytes(length);
}

}  // namespace cuesta
