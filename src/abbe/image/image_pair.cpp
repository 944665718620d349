#include "abbe/image/image_pair.h"

#include "abbe/base/error.h"

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
  std::array<std::size_t, 3> rgb{};
  const std::array<const char*, 3> names{"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto index = image.channel_index(layer + names[c]);
    if (!index) {
      throw_input_error("", "an image without channel " + layer + names[c], "channels R, G and B",
                        image.channels);
    }
    rgb[c] = *index;
  }
  return rgb;
}

std::vector<std::size_t> matching_channels(const Image& image, const Image& reference) {
  check_same_size(image, reference);
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
