#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <type_traits>

#include "base/error.h"
#include "base/file.h"
#include "image/exr.h"

namespace abbe {
namespace {

// Rows handed to OpenEXR at a time: enough ZIP blocks of 16 rows for every core, while the copy in
// half precision stays small.
constexpr int kRowsAtATime = 512;

bool suits_half(const std::string& channel) {
  static const std::set<std::string> colours{"R", "G", "B", "A"};
  return colours.contains(channel) || channel.starts_with("albedo.") || channel.starts_with("N.");
}

// A finite value stays finite in half precision.
Imath::half half_of(float value) {
  if (std::isfinite(value)) value = std::clamp(value, -65504.0f, 65504.0f);
  return Imath::half(value);
}

Imf::Header header_of(const Image& image, const ExrOptions& options) {
  const Vec2i origin = image.data_origin;
  const Vec2i full =
      image.full_size == Vec2i(0) ? Vec2i(image.width, image.height) : image.full_size;
  const Imath::Box2i data_window(
      Imath::V2i(origin.x, origin.y),
      Imath::V2i(origin.x + image.width - 1, origin.y + image.height - 1));
  const Imath::Box2i display_window(Imath::V2i(0, 0), Imath::V2i(full.x - 1, full.y - 1));
  Imf::Header header(display_window, data_window, 1.0f, Imath::V2f(0.0f, 0.0f), 1.0f,
                     Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);

  for (const std::string& channel : image.channels) {
    const bool is_half = options.half && suits_half(channel);
    header.channels().insert(channel, Imf::Channel(is_half ? Imf::HALF : Imf::FLOAT));
  }
  for (const auto& [name, value] : image.attributes) {
    std::visit(
        [&header, &key = name](const auto& typed) {
          using T = std::decay_t<decltype(typed)>;
          header.insert(key, Imf::TypedAttribute<T>(typed));
        },
        value);
  }
  if (options.chromaticities) {
    const auto& xy = *options.chromaticities;
    Imf::addChromaticities(header, Imf::Chromaticities({xy[0], xy[1]}, {xy[2], xy[3]},
                                                       {xy[4], xy[5]}, {xy[6], xy[7]}));
  }
  return header;
}

void write_rows(Imf::OutputFile& file, const Image& image) {
  const Imf::ChannelList& stored = file.header().channels();
  const std::size_t channels = image.channel_count();
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<std::size_t> half_channels;
  for (std::size_t c = 0; c < channels; ++c) {
    if (stored[image.channels[c]].type == Imf::HALF) half_channels.push_back(c);
  }
  std::vector<Imath::half> halves;

  for (int begin = 0; begin < image.height; begin += kRowsAtATime) {
    const int rows = std::min(kRowsAtATime, image.height - begin);
    const std::size_t pixels = width * static_cast<std::size_t>(rows);
    const float* source = image.pixels.data() + static_cast<std::size_t>(begin) * width * channels;

    Imf::FrameBuffer buffer;
    const Imath::V2i origin(image.data_origin.x, image.data_origin.y + begin);
    // OpenEXR only reads from what it is given here; its interface does not say so in const.
    const auto slice = [&](Imf::PixelType type, const void* base, std::size_t stride) {
      return Imf::Slice::Make(type, base, origin, image.width, rows, stride, stride * width);
    };
    for (std::size_t c = 0; c < channels; ++c) {
      if (stored[image.channels[c]].type != Imf::HALF) {
        buffer.insert(image.channels[c], slice(Imf::FLOAT, source + c, channels * sizeof(float)));
      }
    }
    halves.resize(pixels * half_channels.size());
    for (std::size_t h = 0; h < half_channels.size(); ++h) {
      for (std::size_t p = 0; p < pixels; ++p) {
        halves[h * pixels + p] = half_of(source[p * channels + half_channels[h]]);
      }
      buffer.insert(image.channels[half_channels[h]],
                    slice(Imf::HALF, halves.data() + h * pixels, sizeof(Imath::half)));
    }
    file.setFrameBuffer(buffer);
    file.writePixels(rows);
  }
}

void check_image(const std::filesystem::path& file, const Image& image) {
  const std::size_t expected = static_cast<std::size_t>(std::max(image.width, 0)) *
                               static_cast<std::size_t>(std::max(image.height, 0)) *
                               image.channel_count();
  if (expected == 0 || image.pixels.size() != expected) {
    throw_output_error(file.string(),
                       "an image of " + std::to_string(image.width) + "x" +
                           std::to_string(image.height) + " pixels, " +
                           std::to_string(image.channel_count()) + " channels and " +
                           std::to_string(image.pixels.size()) + " values",
                       "at least one pixel and channel, and a value for each");
  }
  const std::set<std::string> names(image.channels.begin(), image.channels.end());
  if (names.size() != image.channel_count()) {
    throw_output_error(file.string(), "two channels of one name", "every channel once");
  }
}

}  // namespace

void write_exr(const std::filesystem::path& file, const Image& image, const ExrOptions& options) {
  check_image(file, image);
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    try {
      Imf::setGlobalThreadCount(static_cast<int>(oneapi::tbb::global_control::active_value(
          oneapi::tbb::global_control::max_allowed_parallelism)));
      std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
      {
        Imf::StdOFStream out(stream, temporary.c_str());
        Imf::OutputFile exr(out, header_of(image, options));
        write_rows(exr, image);
      }
      // OutputFile's destructor writes the table of offsets and keeps its failures to itself.
      stream.close();
      if (!stream) throw std::runtime_error("the file could not be written to its end");
    } catch (const Error&) {
      throw;
    } catch (const std::exception& exception) {
      throw_output_error(file.string(), exception.what(), "a place with room for the image");
    }
  });
}

}  // namespace abbe
