#include "abbe/image/channels.h"

#include <utility>

#include "abbe/base/error.h"

namespace abbe {

Image same_window(const Image& image, std::vector<std::string> channels) {
  Image result;
  result.width = image.width;
  result.height = image.height;
  result.data_origin = image.data_origin;
  result.full_size = image.full_size;
  result.channels = std::move(channels);
  return result;
}

Image grey_pixel() {
  Image image;
  image.width = image.height = 1;
  image.channels = {"R", "G", "B"};
  image.pixels = {0.18f, 0.18f, 0.18f};
  return image;
}

std::vector<float> picked_values(const Image& image, std::span<const std::size_t> channels) {
  std::vector<float> values;
  const std::size_t stride = image.channel_count();
  values.reserve(image.pixels.size() / stride * channels.size());
  for (std::size_t p = 0; p < image.pixels.size(); p += stride) {
    for (const std::size_t c : channels) values.push_back(image.pixels[p + c]);
  }
  return values;
}

std::vector<std::size_t> channel_places(const Image& image, const std::vector<std::string>& names,
                                        const std::string& where) {
  std::vector<std::size_t> places;
  for (const std::string& name : names) {
    const auto index = image.channel_index(name);
    if (!index) {
      throw_input_error(where, "an image without channel " + name, "the reference's channels",
                        names);
    }
    places.push_back(*index);
  }
  return places;
}

std::optional<std::array<std::size_t, 3>> channels_named(const Image& image,
                                                         const std::string& prefix,
                                                         const std::array<const char*, 3>& names) {
  std::array<std::size_t, 3> found{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto index = image.channel_index(prefix + names[i]);
    if (!index) return std::nullopt;
    found[i] = *index;
  }
  return found;
}

std::optional<std::array<std::size_t, 3>> rgb_channels(const Image& image) {
  return channels_named(image, "", {"R", "G", "B"});
}

}  // namespace abbe
