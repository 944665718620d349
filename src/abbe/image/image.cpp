#include "abbe/image/image.h"

#include <algorithm>

namespace abbe {

std::optional<std::size_t> Image::channel_index(const std::string& name) const {
  const auto found = std::find(channels.begin(), channels.end(), name);
  if (found == channels.end()) return std::nullopt;
  return static_cast<std::size_t>(found - channels.begin());
}

}  // namespace abbe
