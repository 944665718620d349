#include "abbe/image/image_pair.h"

#include "abbe/base/error.h"
#include "abbe/image/channels.h"

namespace abbe {

void check_same_size(const Image& image, const Image& reference) {
  const auto size_of = [](const Image& i) {
    return std::to_string(i.width) + "x" + std::to_string(i.height) + " pixels";
  };
  if (image.width != reference.width || image.height != reference.height) {
    throw_input_error("", size_of(image), "the reference's " + size_of(reference));
  }
}

std::array<std::size_t, 3> rgb_indices(const Image& image, const std::string& layer) {
  const auto rgb = channels_named(image, layer, {"R", "G", "B"});
  if (!rgb) {
    throw_input_error("", "an image without channels " + layer + "R, G and B",
                      "channels R, G and B", image.channels);
  }
  return *rgb;
}

std::vector<std::size_t> matching_channels(const Image& image, const Image& reference) {
  check_same_size(image, reference);
  return channel_places(image, reference.channels);
}

}  // namespace abbe
