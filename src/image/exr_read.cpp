#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <set>
#include <tuple>

#include "base/error.h"
#include "image/exr.h"

namespace abbe {
namespace {

constexpr int kLongestSide_px = 65536;
constexpr int kLongestTileSide_px = 4096;
constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
constexpr std::int64_t kMostValues = std::int64_t{1} << 31;
constexpr std::size_t kMostChannels = 4096;
constexpr int kFarthestOrigin_px = 1 << 24;

// A file that claims more pixels than it holds fails before more memory than this many rows take.
constexpr int kRowsAtATime = 256;

[[noreturn]] void reject(const std::filesystem::path& file, std::string found,
                         std::string expected) {
  throw_input_error(file.string(), std::move(found), std::move(expected));
}

std::uint32_t little_endian(const std::array<char, 4>& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

// Walks the attributes of the header: OpenEXR allocates what a size field claims before it finds
// the file too short, and parts or deep data are nothing we read.
void check_structure(const std::filesystem::path& file, std::ifstream& stream,
                     std::uint64_t file_size) {
  std::array<char, 4> word{};
  const auto next_word = [&] {
    if (!stream.read(word.data(), 4)) reject(file, "a file that ends in its header", "an EXR");
    return little_endian(word);
  };
  if (file_size < 8 || next_word() != 20000630u) {
    reject(file, "a file that is not an EXR", "an OpenEXR image");
  }
  const std::uint32_t version = next_word();
  if ((version & 0xffu) != 2u) reject(file, "an unknown EXR version", "version 2");
  if ((version & 0x1800u) != 0) {
    reject(file, "an EXR of deep data or several parts", "a single flat image");
  }
  const auto skip_name = [&] {
    int length = 0;
    for (char c = '\0'; stream.get(c) && c != '\0'; ++length) {
      if (length > 255) reject(file, "a name of more than 255 letters in the header", "an EXR");
    }
    if (!stream) reject(file, "a file that ends in its header", "an EXR");
    return length;
  };
  while (skip_name() > 0) {
    skip_name();
    const std::uint64_t size = next_word();
    const auto at = static_cast<std::uint64_t>(stream.tellg());
    if (size > file_size - at) reject(file, "an attribute longer than the file", "an EXR");
    stream.seekg(static_cast<std::streamoff>(at + size));
  }
  stream.clear();
  stream.seekg(0);
}

std::string compression_name(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return "none";
    case Imf::RLE_COMPRESSION:
      return "rle";
    case Imf::ZIPS_COMPRESSION:
      return "zips";
    case Imf::ZIP_COMPRESSION:
      return "zip";
    case Imf::PIZ_COMPRESSION:
      return "piz";
    case Imf::PXR24_COMPRESSION:
      return "pxr24";
    case Imf::B44_COMPRESSION:
      return "b44";
    case Imf::B44A_COMPRESSION:
      return "b44a";
    case Imf::DWAA_COMPRESSION:
      return "dwaa";
    case Imf::DWAB_COMPRESSION:
      return "dwab";
    default:
      return "unknown";
  }
}

std::string type_name(Imf::PixelType type) {
  return type == Imf::HALF ? "half" : type == Imf::FLOAT ? "float" : "uint";
}

// R, G, B, A, then spectral channels by wavelength, then the others as text.
std::tuple<int, double, std::string> channel_rank(const std::string& name) {
  constexpr std::array<const char*, 4> kFirst{"R", "G", "B", "A"};
  for (int i = 0; i < 4; ++i) {
    if (name == kFirst[static_cast<std::size_t>(i)]) return {i, 0.0, name};
  }
  if (const auto wavelength_nm = spectral_channel_wavelength_nm(name)) {
    return {4, *wavelength_nm, name};
  }
  return {5, 0.0, name};
}

// What OpenEXR itself writes and what a copy of the image must not inherit.
bool is_structural(const std::string& attribute) {
  static const std::set<std::string> names{"type", "name", "version", "chunkCount"};
  return names.contains(attribute);
}

template <typename T>
void copy_if_typed(const std::string& name, const Imf::Attribute& attribute,
                   std::map<std::string, Attribute>& attributes) {
  if (const auto* typed = dynamic_cast<const Imf::TypedAttribute<T>*>(&attribute)) {
    attributes[name] = typed->value();
  }
}

ExrHeader understood(const std::filesystem::path& file, const Imf::Header& header) {
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  const auto extent = [](int low, int high) { return std::int64_t{high} - low + 1; };
  const std::int64_t width = extent(data.min.x, data.max.x);
  const std::int64_t height = extent(data.min.y, data.max.y);
  if (width < 1 || height < 1 || width > kLongestSide_px || height > kLongestSide_px ||
      width * height > kMostPixels) {
    reject(file, std::to_string(width) + "x" + std::to_string(height) + " pixels",
           "sides of 1 to 65536 and at most 2^28 pixels");
  }
  const std::int64_t full_width = extent(display.min.x, display.max.x);
  const std::int64_t full_height = extent(display.min.y, display.max.y);
  const auto is_near = [](std::int64_t v) { return std::abs(v) <= kFarthestOrigin_px; };
  if (!is_near(data.min.x) || !is_near(data.min.y) || !is_near(display.min.x) ||
      !is_near(display.min.y) || full_width < 1 || full_height < 1 || !is_near(full_width) ||
      !is_near(full_height)) {
    reject(file, "a display window out of bounds", "windows within 2^24 pixels of the origin");
  }

  ExrHeader result;
  result.width = static_cast<int>(width);
  result.height = static_cast<int>(height);
  if (data.min != display.min || data.max != display.max) {
    result.data_origin = {data.min.x - display.min.x, data.min.y - display.min.y};
    result.full_size = {static_cast<int>(full_width), static_cast<int>(full_height)};
  }
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) {
      reject(file, std::string("subsampled channel ") + it.name(), "a value for every pixel");
    }
    result.channels.push_back({it.name(), type_name(it.channel().type)});
    if (result.channels.size() > kMostChannels) {
      reject(file, "more than 4096 channels", "at most 4096");
    }
  }
  if (result.channels.empty()) reject(file, "an EXR without channels", "at least one channel");
  if (width * height * static_cast<std::int64_t>(result.channels.size()) > kMostValues) {
    reject(file, "more than 2^31 values", "at most 2^31 values, pixels times channels");
  }
  std::sort(result.channels.begin(), result.channels.end(), [](const auto& a, const auto& b) {
    return channel_rank(a.name) < channel_rank(b.name);
  });

  result.compression = compression_name(header.compression());
  if (Imf::hasChromaticities(header)) {
    const Imf::Chromaticities& xy = Imf::chromaticities(header);
    result.chromaticities = {xy.red.x,  xy.red.y,  xy.green.x, xy.green.y,
                             xy.blue.x, xy.blue.y, xy.white.x, xy.white.y};
  }
  for (auto it = header.begin(); it != header.end(); ++it) {
    if (is_structural(it.name())) continue;
    copy_if_typed<std::string>(it.name(), it.attribute(), result.attributes);
    copy_if_typed<int>(it.name(), it.attribute(), result.attributes);
    copy_if_typed<float>(it.name(), it.attribute(), result.attributes);
    copy_if_typed<double>(it.name(), it.attribute(), result.attributes);
  }
  return result;
}

// An EXR whose header has been found good. OpenEXR's own exceptions end here.
class OpenExr {
 public:
  explicit OpenExr(const std::filesystem::path& path) : path_(path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
      reject(path,
             std::filesystem::exists(path, ignored) ? "something that is not a regular file"
                                                    : "no such file",
             "an EXR image");
    }
    const std::uintmax_t file_size = std::filesystem::file_size(path, ignored);
    stream_.open(path, std::ios::binary);
    if (ignored || !stream_) reject(path, "a file that cannot be read", "an EXR image");
    check_structure(path, stream_, file_size);
    translated([&] {
      Imf::Header::setMaxImageSize(kLongestSide_px, kLongestSide_px);
      Imf::Header::setMaxTileSize(kLongestTileSide_px, kLongestTileSide_px);
      input_ = std::make_unique<Imf::StdIFStream>(stream_, path.c_str());
      file_ = std::make_unique<Imf::MultiPartInputFile>(*input_, 0, false);
      header = understood(path, file_->header(0));
      if (!file_->partComplete(0)) reject(path, "a truncated EXR", "a whole file");
    });
  }

  template <typename Body>
  void translated(const Body& body) const {
    try {
      body();
    } catch (const Error&) {
      throw;
    } catch (const std::exception& exception) {
      reject(path_, std::string("a broken EXR: ") + exception.what(), "an EXR image");
    }
  }

  Imf::MultiPartInputFile& file() { return *file_; }

  ExrHeader header;

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  std::unique_ptr<Imf::StdIFStream> input_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
};

}  // namespace

ExrHeader read_exr_header(const std::filesystem::path& file) {
  return OpenExr(file).header;
}

Image read_exr(const std::filesystem::path& file) {
  OpenExr exr(file);
  Image image;
  image.width = exr.header.width;
  image.height = exr.header.height;
  image.data_origin = exr.header.data_origin;
  image.full_size = exr.header.full_size;
  image.attributes = exr.header.attributes;
  for (const auto& channel : exr.header.channels) image.channels.push_back(channel.name);

  exr.translated([&] {
    Imf::InputPart part(exr.file(), 0);
    const Imath::V2i origin = part.header().dataWindow().min;
    const std::size_t channels = image.channel_count();
    const std::size_t row_values = static_cast<std::size_t>(image.width) * channels;
    image.pixels.reserve(row_values * static_cast<std::size_t>(image.height));
    for (int begin = 0; begin < image.height; begin += kRowsAtATime) {
      const int rows = std::min(kRowsAtATime, image.height - begin);
      const std::size_t offset = row_values * static_cast<std::size_t>(begin);
      image.pixels.resize(offset + row_values * static_cast<std::size_t>(rows));
      Imf::FrameBuffer buffer;
      for (std::size_t c = 0; c < channels; ++c) {
        buffer.insert(image.channels[c],
                      Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + offset + c,
                                       Imath::V2i(origin.x, origin.y + begin), image.width, rows,
                                       channels * sizeof(float), row_values * sizeof(float)));
      }
      part.setFrameBuffer(buffer);
      part.readPixels(origin.y + begin, origin.y + begin + rows - 1);
    }
  });
  return image;
}

}  // namespace abbe
