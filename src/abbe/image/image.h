/// Pixel buffers with named channels and attributes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// A value beside the pixels. Vec2f pairs and string lists are not needed so far.
using Attribute = std::variant<std::string, int, float, double>;

/// What the numbers of an id channel stand for.
struct IdNames {
  std::string channel;
  std::map<std::uint32_t, std::string> names;
};

/// Float pixels, interleaved: value of channel c at (x, y) is pixels[(y·width + x)·channels + c].
/// Row 0 is the top row.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;
  std::vector<float> pixels;
  std::map<std::string, Attribute> attributes;
  std::vector<IdNames> id_names;

  /// Position of this image in a larger one: a crop keeps the full image as its display window.
  Vec2i data_origin{0, 0};
  Vec2i full_size{0, 0};  ///< 0, 0 means the image is whole.

  std::size_t channel_count() const { return channels.size(); }
  float& at(int x, int y, std::size_t c) {
    return pixels[(static_cast<std::size_t>(y) * width + x) * channels.size() + c];
  }
  float at(int x, int y, std::size_t c) const {
    return pixels[(static_cast<std::size_t>(y) * width + x) * channels.size() + c];
  }
  /// Where a channel is among `channels`; nothing when there is none of that name.
  std::optional<std::size_t> channel_index(const std::string& name) const;
};

}  // namespace abbe
