#include <GL/osmesa.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cstdint>
#include <vector>

#include "ooc/check.h"
#include "runtime/draw/gl_context.h"
#include "runtime/draw/shared_library.h"

namespace cuesta {
namespace {

/// The library, loaded when the first context is made: it brings LLVM, 40 MiB of memory that a program that
/// draws nothing (a build within a budget, a server) should not pay for.
struct OsMesa {
  decltype(&OSMesaCreateContextAttribs) create = nullptr;
  decltype(&OSMesaDestroyContext) destroy = nullptr;
  decltype(&OSMesaMakeCurrent) make_current = nullptr;
  decltype(&OSMesaGetCurrentContext) current = nullptr;
  decltype(&OSMesaGetProcAddress) proc = nullptr;
};

/// Mesa allocates for each picture and frees it after it. The C library would give that back to the system,
/// and each picture be paid for in page faults again: some 1,000 of 12 µs each on a virtual machine, a third
/// of its time.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kept_bytes = 64 << 20, largest_bytes = 32 << 20;
  mallopt(M_TRIM_THRESHOLD, kept_bytes);
  mallopt(M_MMAP_THRESHOLD, largest_bytes);
#endif
}

/// Null if the system has no OSMesa. Stays loaded.
const OsMesa* osmesa() {
  static const OsMesa functions = [] {
    OsMesa f;
    void* const library = ::dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    const bool found = library && find_function(library, "OSMesaCreateContextAttribs", f.create) &&
                       find_function(library, "OSMesaDestroyContext", f.destroy) &&
                       find_function(library, "OSMesaMakeCurrent", f.make_current) &&
                       find_function(library, "OSMesaGetCurrentContext", f.current) &&
                       find_function(library, "OSMesaGetProcAddress", f.proc);
    if (found) keep_freed_memory();
    return found ? f : OsMesa{};
  }();
  return functions.proc ? &functions : nullptr;
}

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext(const OsMesa& library, OSMesaContext context, int width_px, int height_px)
      : library_(library),
        context_(context),
        width_px_(width_px),
        height_px_(height_px),
        pixels_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;
  ~OsMesaContext() override { library_.destroy(context_); }

  bool make_current() override {
    if (library_.current() == context_) return true;
    return library_.make_current(context_, pixels_.data(), GL_UNSIGNED_BYTE, width_px_, height_px_) ==
           GL_TRUE;
  }
  GlProc proc(const char* name) const override { return library_.proc(name); }
  std::string_view kind() const override { return "osmesa"; }

 private:
  const OsMesa& library_;
  OSMesaContext context_;
  int width_px_, height_px_;
  std::vector<std::uint32_t> pixels_;  ///< the default framebuffer, which must outlive the context
};

}  // namespace

Result<std::unique_ptr<GlContext>> make_osmesa_context(int width_px, int height_px) {
  CUESTA_CHECK(width_px > 0 && height_px > 0, width_px, height_px);
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  const OsMesa* const library = osmesa();
  if (!library)
    return fail(ErrorCode::not_found, "libOSMesa.so.8", "",
                "drawing without a screen needs OSMesa; install it (Debian: libosmesa6)");
  const OSMesaContext handle = library->create(attributes, nullptr);
  if (!handle) return fail(ErrorCode::io, "", "", "OSMesa gives no OpenGL 3.3 core context");
  auto context = std::make_unique<OsMesaContext>(*library, handle, width_px, height_px);
  if (!context->make_current()) return fail(ErrorCode::io, "", "", "OSMesa cannot make its context current");
  return std::unique_ptr<GlContext>(std::move(context));
}

}  // namespace cuesta
