#include <GL/osmesa.h>

#include <cstdint>
#include <vector>

#include "ooc/check.h"
#include "runtime/draw/gl_context.h"

namespace cuesta {
namespace {

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext(OSMesaContext context, int width_px, int height_px)
      : context_(context),
        width_px_(width_px),
        height_px_(height_px),
        pixels_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;
  ~OsMesaContext() override { OSMesaDestroyContext(context_); }

  bool make_current() override {
    if (OSMesaGetCurrentContext() == context_) return true;
    return OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, width_px_, height_px_) == GL_TRUE;
  }
  GlProc proc(const char* name) const override { return OSMesaGetProcAddress(name); }
  std::string_view kind() const override { return "osmesa"; }

 private:
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
  const OSMesaContext handle = OSMesaCreateContextAttribs(attributes, nullptr);
  if (!handle) return fail(ErrorCode::io, "", "", "OSMesa gives no OpenGL 3.3 core context");
  auto context = std::make_unique<OsMesaContext>(handle, width_px, height_px);
  if (!context->make_current()) return fail(ErrorCode::io, "", "", "OSMesa cannot make its context current");
  return std::unique_ptr<GlContext>(std::move(context));
}

}  // namespace cuesta
