#include "ooc/map_guard.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <mutex>

// Why the handler may do what it does, although almost nothing is allowed in one:
//  - It acts only on faults (BUS_ADRERR), which come from an instruction of this very thread that touched a
//  page,
//    never from another process or at any other time. The code between lock() and unlock() touches no guarded
//    map, so no thread holds the lock when it faults: another thread has it, which goes on and gives it back.
//    A second fault within the handler cannot be, as it touches the list and its own stack only.
//  - Lock, list and counters are lock-free atomics and plain memory; there is no allocation.
//  - Beside mmap it calls sigaction and raise, which POSIX lists as safe. It does not list mmap; on Linux
//  that is
//    a system call and nothing around it (in glibc and musl), and it takes no lock of the C library.
//  - errno is put back.

namespace cuesta {

struct MapGuard::Range {
  std::uintptr_t begin = 0, end = 0;  ///< whole pages
  std::atomic<bool> faulted{false};
  Range* next = nullptr;
};

namespace {

static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<unsigned>::is_always_lock_free,
              "used in a signal handler");

std::atomic_flag list_lock;
MapGuard::Range* list = nullptr;  // under list_lock
std::atomic<unsigned> foreign_guards{0}, foreign_faults{0};
struct sigaction previous {};
std::uintptr_t page_bytes = 4096;

class Locked {
 public:
  Locked() {
    while (list_lock.test_and_set(std::memory_order_acquire)) {
    }
  }
  ~Locked() { list_lock.clear(std::memory_order_release); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;
};

bool put_zeros(std::uintptr_t begin, std::uintptr_t end) {
  constexpr int flags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED | MAP_NORESERVE;
  return ::mmap(reinterpret_cast<void*>(begin), end - begin, PROT_READ, flags, -1, 0) != MAP_FAILED;
}

/// True if the instruction can be tried again.
bool is_mended(std::uintptr_t address) {
  const std::uintptr_t page = address / page_bytes * page_bytes;
  {
    const Locked locked;
    for (MapGuard::Range* r = list; r; r = r->next) {
      if (address < r->begin || address >= r->end) continue;
      r->faulted = true;
      return put_zeros(page, r->end);
    }
  }
  if (foreign_guards == 0) return false;
  ++foreign_faults;
  return put_zeros(page, page + page_bytes);
}

void pass_on(int signal, siginfo_t* info, void* context) {
  if ((previous.sa_flags & SA_SIGINFO) != 0) return previous.sa_sigaction(signal, info, context);
  if (previous.sa_handler != SIG_DFL && previous.sa_handler != SIG_IGN) return previous.sa_handler(signal);
  // A fault comes again when the instruction does, a signal that was sent only if it is sent again.
  ::sigaction(signal, &previous, nullptr);
  if (info->si_code <= 0 && previous.sa_handler == SIG_DFL) ::raise(signal);
}

void on_fault(int signal, siginfo_t* info, void* context) {
  const int number = errno;
  if (info->si_code != BUS_ADRERR || !is_mended(reinterpret_cast<std::uintptr_t>(info->si_addr)))
    pass_on(signal, info, context);
  errno = number;
}

void install() {
  static std::once_flag once;
  std::call_once(once, [] {
    page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction action {};
    action.sa_sigaction = on_fault;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGBUS, nullptr, &previous);  // before a fault can ask for it
    ::sigaction(SIGBUS, &action, nullptr);
  });
}

}  // namespace

MapGuard::MapGuard(const void* begin, std::size_t bytes) : range_(new Range) {
  install();
  range_->begin = reinterpret_cast<std::uintptr_t>(begin);
  range_->end = (range_->begin + bytes + page_bytes - 1) / page_bytes * page_bytes;
  const Locked locked;
  range_->next = list;
  list = range_.get();
}

void MapGuard::Remove::operator()(Range* range) const {
  {
    const Locked locked;
    MapGuard::Range** at = &list;
    while (*at != range) at = &(*at)->next;
    *at = range->next;
  }
  delete range;
}

bool MapGuard::has_faulted() const {
  return range_ && range_->faulted;
}

ForeignMapGuard::ForeignMapGuard() : faults_before_(foreign_faults) {
  install();
  ++foreign_guards;
}

ForeignMapGuard::~ForeignMapGuard() {
  --foreign_guards;
}

bool ForeignMapGuard::has_faulted() const {
  return foreign_faults != faults_before_;
}

}  // namespace cuesta
