#include "runtime/delivered_loader.h"

#include <utility>

namespace cuesta {

void DeliveredLoader::request(PageRequest request) {
  const BlockRef& block = file_.directory().pages[request.id].block;
  if (bytes_.has({block.offset, block.bytes})) {
    done_.push_back(load_page(file_, pool_, request));
    return;
  }
  asked_.push_back(request.id);
  waiting_.emplace(request.id, std::move(request));
}

std::optional<LoadedPage> DeliveredLoader::finished() {
  if (done_.empty()) return {};
  LoadedPage page = std::move(done_.front());
  done_.pop_front();
  return page;
}

std::vector<PageId> DeliveredLoader::take_asked() {
  return std::exchange(asked_, {});
}

bool DeliveredLoader::bring(PageId id, std::vector<std::byte> stored) {
  const auto request = waiting_.extract(id);
  if (request.empty()) return false;
  bytes_.deliver(file_.directory().pages[id].block.offset, std::move(stored));
  done_.push_back(load_page(file_, pool_, request.mapped()));
  bytes_.forget();
  return true;
}

bool DeliveredLoader::give_up(PageId id, Error error) {
  const auto request = waiting_.extract(id);
  if (request.empty()) return false;
  done_.push_back({id, request.mapped().run, fail(std::move(error))});
  return true;
}

}  // namespace cuesta
