#pragma once
/// Pages whose bytes are brought from outside, as by range requests: asks for them, and waits for nothing.

#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "ooc/delivered_bytes.h"
#include "runtime/page_loader.h"

namespace cuesta {

/// A page whose bytes are there is loaded when it is requested; another is asked for, and loaded when it is
/// brought: on the bringer's time, not on a frame's. Until then what leans on it is drawn coarser. Threads:
/// one.
class DeliveredLoader final : public PageLoader {
 public:
  /// Requests under way at a time: enough to keep some connections busy, few enough to follow a camera.
  static constexpr std::uint32_t usual_width = 12;

  /// @param file  reads from `bytes`. All outlive the loader.
  DeliveredLoader(const CuestaFile& file, GeometryPool& pool, DeliveredBytes& bytes)
      : file_(file), pool_(pool), bytes_(bytes) {}

  void request(PageRequest request) override;
  std::optional<LoadedPage> finished() override;
  void wait() override {}
  std::uint32_t width() const override { return usual_width; }

  /// Pages asked for since the last call, the most urgent first.
  std::vector<PageId> take_asked();
  /// The page's stored bytes.   @return false if it is not asked for.
  bool bring(PageId id, std::vector<std::byte> stored);
  /// The page's bytes cannot be had: it stays coarser, and is not asked for again.   @return false if it is
  /// not asked for.
  bool give_up(PageId id, Error error);

 private:
  const CuestaFile& file_;
  GeometryPool& pool_;
  DeliveredBytes& bytes_;
  std::map<PageId, PageRequest> waiting_;
  std::vector<PageId> asked_;
  std::deque<LoadedPage> done_;
};

}  // namespace cuesta
