#include "image/image_pair.h"

#include "base/error.h"

namespace abbe {

std::vector<std::size_t> matching_channels(const Image& image, const Image& reference) {
  const auto size_of = [](const Image& i) {
    return std::to_string(i.width) + "x" + std::to_string(i.height) + " pixels";
  };
  if (image.width != reference.width || image.height != reference.height) {
    throw_input_error("", size_of(image), "the reference's " + size_of(reference));
  }
  std::vector<std::size_t> indices;
  for (const std::string& channel : reference.channels) {
    const auto index = image.channel_index(channel);
    if (!index) {
      throw_input_error("", "an image without channel " + channel, "the reference's channels",
                        reference.channels);
    }
    indices.push_back(*index);
  }
  return indices;
}

}  // namespace abbe
