#pragma once
/// The start page: what is served, as HTML without scripts.

#include <string>

#include "apps/serve/catalogue.h"

namespace cuesta::serve {

/// Names and attributions are escaped. Links to the web page where there is one.
/// @param has_tiles  whether there are links to tiles.
std::string start_page(const Contents& contents, bool has_tiles);

}  // namespace cuesta::serve
