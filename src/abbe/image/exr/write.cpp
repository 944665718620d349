#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIDManifest.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <string_view>
#include <type_traits>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/image/exr/compression.h"
#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

// Rows handed to OpenEXR at a time: enough ZIP blocks of 16 rows for every core, while the copy in
// half precision stays small. Whole rows of tiles, whatever their side.
constexpr int kRowsAtATime = 512;

bool suits_half(const std::string& channel) {
  static const std::set<std::string> colours{"R", "G", "B", "A"};
  return colours.contains(channel) || channel.ends_with(".R") || channel.ends_with(".G") ||
         channel.ends_with(".B") || channel.starts_with("N.");
}

// A finite value stays finite in half precision.
Imath::half half_of(float value) {
  if (std::isfinite(value)) value = std::clamp(value, -65504.0f, 65504.0f);
  return Imath::half(value);
}

// What is no number or negative is nothing: id 0.
std::uint32_t id_of(float value) {
  if (!(value > 0.0f)) return 0;
  return static_cast<std::uint32_t>(std::min(std::round(double{value}), 4294967295.0));
}

Imf::PixelType stored_type(const Image& image, const std::string& channel,
                           const ExrOptions& options) {
  for (const IdNames& ids : image.id_names) {
    if (ids.channel == channel) return Imf::UINT;
  }
  return options.half && suits_half(channel) ? Imf::HALF : Imf::FLOAT;
}

/// One part of a file: its name and the indices of its channels.
struct Part {
  std::string name;
  std::vector<std::size_t> channels;
};

std::string part_of(const std::string& channel) {
  if (channel.size() == 1 && std::string_view("RGBA").find(channel) != std::string_view::npos) {
    return "rgba";
  }
  if (spectral_channel_wavelength_nm(channel) || reflective_channel_wavelength_nm(channel)) {
    return "spectral";
  }
  return channel.substr(0, channel.find('.'));
}

std::vector<Part> parts_of(const Image& image, bool multi_part) {
  std::vector<Part> parts;
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    const std::string name = multi_part ? part_of(image.channels[c]) : "";
    const auto same = [&name](const Part& part) { return part.name == name; };
    auto part = std::find_if(parts.begin(), parts.end(), same);
    if (part == parts.end()) part = parts.insert(parts.end(), {name, {}});
    part->channels.push_back(c);
  }
  return parts;
}

void add_id_names(Imf::Header& header, const Image& image) {
  Imf::IDManifest manifest;
  for (const IdNames& ids : image.id_names) {
    if (header.channels().findChannel(ids.channel) == nullptr) continue;
    Imf::IDManifest::ChannelGroupManifest& group = manifest.add(ids.channel);
    group.setComponent("name");
    group.setLifetime(Imf::IDManifest::LIFETIME_SHOT);
    group.setHashScheme(Imf::IDManifest::NOTHASHED);
    group.setEncodingScheme(Imf::IDManifest::ID_SCHEME);
    for (const auto& [id, name] : ids.names) group.insert(id, name);
  }
  if (manifest.size() > 0) Imf::addIDManifest(header, Imf::CompressedIDManifest(manifest));
}

Imf::Header header_of(const Image& image, const Part& part, const ExrOptions& options) {
  const Vec2i origin = image.data_origin;
  const Vec2i full =
      image.full_size == Vec2i(0) ? Vec2i(image.width, image.height) : image.full_size;
  const Imath::Box2i data_window(
      Imath::V2i(origin.x, origin.y),
      Imath::V2i(origin.x + image.width - 1, origin.y + image.height - 1));
  const Imath::Box2i display_window(Imath::V2i(0, 0), Imath::V2i(full.x - 1, full.y - 1));
  Imf::Header header(display_window, data_window, 1.0f, Imath::V2f(0.0f, 0.0f), 1.0f,
                     Imf::INCREASING_Y, exr_compression(options.compression));

  for (const std::size_t c : part.channels) {
    const std::string& channel = image.channels[c];
    header.channels().insert(channel, Imf::Channel(stored_type(image, channel, options)));
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
  add_id_names(header, image);
  if (options.tile_size > 0) {
    const auto side = static_cast<unsigned>(options.tile_size);
    header.setTileDescription(Imf::TileDescription(side, side, Imf::ONE_LEVEL));
  }
  header.setType(options.tile_size > 0 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  if (!part.name.empty()) header.setName(part.name);
  return header;
}

/// Some rows of the channels of a part, as OpenEXR reads them: floats where they lie, the rest
/// converted.
class Rows {
 public:
  Rows(const Image& image, const Part& part, const Imf::ChannelList& stored)
      : image_(image), part_(part), stored_(stored) {}

  Imf::FrameBuffer buffer(int begin, int rows) {
    const std::size_t channels = image_.channel_count();
    const auto width = static_cast<std::size_t>(image_.width);
    const std::size_t pixels = width * static_cast<std::size_t>(rows);
    const float* source = image_.pixels.data() + static_cast<std::size_t>(begin) * width * channels;
    halves_.clear();
    ids_.clear();
    Imf::FrameBuffer buffer;
    const Imath::V2i origin(image_.data_origin.x, image_.data_origin.y + begin);
    // OpenEXR only reads from what it is given here; its interface does not say so in const.
    const auto insert = [&](std::size_t c, Imf::PixelType type, const void* base,
                            std::size_t stride) {
      buffer.insert(image_.channels[c], Imf::Slice::Make(type, base, origin, image_.width, rows,
                                                         stride, stride * width));
    };
    for (const std::size_t c : part_.channels) {
      switch (stored_[image_.channels[c]].type) {
        case Imf::HALF:
          insert(c, Imf::HALF, converted(halves_, source + c, pixels, half_of),
                 sizeof(Imath::half));
          break;
        case Imf::UINT:
          insert(c, Imf::UINT, converted(ids_, source + c, pixels, id_of), sizeof(std::uint32_t));
          break;
        default:
          insert(c, Imf::FLOAT, source + c, channels * sizeof(float));
          break;
      }
    }
    return buffer;
  }

 private:
  template <typename T, typename Convert>
  const T* converted(std::vector<std::vector<T>>& store, const float* source, std::size_t pixels,
                     const Convert& convert) const {
    std::vector<T>& values = store.emplace_back(pixels);
    for (std::size_t p = 0; p < pixels; ++p) {
      values[p] = convert(source[p * image_.channel_count()]);
    }
    return values.data();
  }

  const Image& image_;
  const Part& part_;
  const Imf::ChannelList& stored_;
  std::vector<std::vector<Imath::half>> halves_;
  std::vector<std::vector<std::uint32_t>> ids_;
};

void write_part(Imf::MultiPartOutputFile& file, int number, const Image& image, const Part& part,
                const ExrOptions& options) {
  Rows source(image, part, file.header(number).channels());
  const auto for_all_rows = [&](int step, const auto& write) {
    for (int begin = 0; begin < image.height; begin += step) {
      const int rows = std::min(step, image.height - begin);
      write(source.buffer(begin, rows), begin, rows);
    }
  };
  if (options.tile_size == 0) {
    Imf::OutputPart out(file, number);
    for_all_rows(kRowsAtATime, [&out](const Imf::FrameBuffer& buffer, int, int rows) {
      out.setFrameBuffer(buffer);
      out.writePixels(rows);
    });
    return;
  }
  Imf::TiledOutputPart out(file, number);
  const int side = options.tile_size;
  const int tiles = std::max(1, kRowsAtATime / side);
  for_all_rows(tiles * side, [&](const Imf::FrameBuffer& buffer, int begin, int rows) {
    out.setFrameBuffer(buffer);
    out.writeTiles(0, out.numXTiles() - 1, begin / side, (begin + rows - 1) / side);
  });
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

void check_exr_options(const ExrOptions& options) {
  check_choice("compression", options.compression, "a compression of OpenEXR", exr_compressions());
  constexpr int kSmallestTile_px = 8;
  constexpr int kLargestTile_px = 4096;
  if (options.tile_size != 0 &&
      (options.tile_size < kSmallestTile_px || options.tile_size > kLargestTile_px)) {
    throw_usage_error("tile_size", std::to_string(options.tile_size),
                      "the side of a tile, 8 to 4096 pixels");
  }
}

void write_exr(const std::filesystem::path& file, const Image& image, const ExrOptions& options) {
  check_exr_options(options);
  check_image(file, image);
  const std::vector<Part> parts = parts_of(image, options.multi_part);
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    try {
      Imf::setGlobalThreadCount(static_cast<int>(oneapi::tbb::global_control::active_value(
          oneapi::tbb::global_control::max_allowed_parallelism)));
      std::vector<Imf::Header> headers;
      headers.reserve(parts.size());
      for (const Part& part : parts) headers.push_back(header_of(image, part, options));
      std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
      {
        Imf::StdOFStream out(stream, temporary.c_str());
        Imf::MultiPartOutputFile exr(out, headers.data(), static_cast<int>(headers.size()));
        for (std::size_t i = 0; i < parts.size(); ++i) {
          write_part(exr, static_cast<int>(i), image, parts[i], options);
        }
      }
      // The file's destructor writes the table of offsets and keeps its failures to itself.
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
