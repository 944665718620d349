#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIDManifest.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <set>
#include <tuple>

#include "abbe/base/error.h"
#include "abbe/image/exr/compression.h"
#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

constexpr int kLongestSide_px = 65536;
constexpr int kLongestTileSide_px = 4096;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr std::int64_t kMaxValues = std::int64_t{1} << 31;
constexpr std::size_t kMaxChannels = 4096;
constexpr int kMaxParts = 256;
constexpr std::uint64_t kLongestManifest = 64u << 20;
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

// Walks the attributes of the headers: OpenEXR allocates what a size field claims before it finds
// the file too short, and deep data are nothing we read.
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
  constexpr std::uint32_t kDeepFlag = 0x800u;
  constexpr std::uint32_t kMultiPartFlag = 0x1000u;
  if ((version & kDeepFlag) != 0) reject(file, "an EXR of deep data", "a flat image");
  const auto skip_name = [&] {
    int length = 0;
    for (char c = '\0'; stream.get(c) && c != '\0'; ++length) {
      if (length > 255) reject(file, "a name of more than 255 letters in the header", "an EXR");
    }
    if (!stream) reject(file, "a file that ends in its header", "an EXR");
    return length;
  };
  // Whether there was a header; the list of a file of several parts ends with an empty one.
  const auto skip_header = [&] {
    bool any = false;
    while (skip_name() > 0) {
      any = true;
      skip_name();
      const std::uint64_t size = next_word();
      const auto at = static_cast<std::uint64_t>(stream.tellg());
      if (size > file_size - at) reject(file, "an attribute longer than the file", "an EXR");
      stream.seekg(static_cast<std::streamoff>(at + size));
    }
    return any;
  };
  skip_header();
  if ((version & kMultiPartFlag) != 0) {
    for (int parts = 1; skip_header(); ++parts) {
      if (parts == kMaxParts) reject(file, "an EXR of more than 256 parts", "at most 256");
    }
  }
  stream.clear();
  stream.seekg(0);
}

std::string type_name(Imf::PixelType type) {
  return type == Imf::HALF ? "half" : type == Imf::FLOAT ? "float" : "uint";
}

// R, G, B, A, then spectral channels by wavelength, emissive before reflective, then the others as
// text.
std::tuple<int, double, std::string> channel_rank(const std::string& name) {
  constexpr std::array<const char*, 4> kFirst{"R", "G", "B", "A"};
  for (int i = 0; i < 4; ++i) {
    if (name == kFirst[static_cast<std::size_t>(i)]) return {i, 0.0, name};
  }
  if (const auto wavelength_nm = spectral_channel_wavelength_nm(name)) {
    return {4, *wavelength_nm, name};
  }
  if (const auto wavelength_nm = reflective_channel_wavelength_nm(name)) {
    return {5, *wavelength_nm, name};
  }
  return {6, 0.0, name};
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

// Where the pixels of a part lie and how they are kept; channels and attributes are left out.
ExrHeader windows_of(const std::filesystem::path& file, const Imf::Header& header) {
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  const auto extent = [](int low, int high) { return std::int64_t{high} - low + 1; };
  const std::int64_t width = extent(data.min.x, data.max.x);
  const std::int64_t height = extent(data.min.y, data.max.y);
  if (width < 1 || height < 1 || width > kLongestSide_px || height > kLongestSide_px ||
      width * height > kMaxPixels) {
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
  result.compression = exr_compression_name(header.compression());
  if (header.hasTileDescription()) {
    result.tile_size = static_cast<int>(header.tileDescription().xSize);
  }
  return result;
}

std::vector<IdNames> id_names_of(const Imf::Header& header) {
  std::vector<IdNames> result;
  if (!Imf::hasIDManifest(header)) return result;
  const Imf::CompressedIDManifest& compressed = Imf::idManifest(header);
  if (compressed._uncompressedDataSize > kLongestManifest) return result;
  const Imf::IDManifest manifest(compressed);
  for (std::size_t i = 0; i < manifest.size(); ++i) {
    const auto& group = manifest[i];
    if (group.getComponents().size() != 1) continue;
    for (const std::string& channel : group.getChannels()) {
      IdNames ids{channel, {}};
      for (auto entry = group.begin(); entry != group.end(); ++entry) {
        ids.names[static_cast<std::uint32_t>(entry.id())] = entry.text().front();
      }
      result.push_back(std::move(ids));
    }
  }
  return result;
}

void add_attributes(const Imf::Header& header, ExrHeader& result) {
  if (!result.chromaticities && Imf::hasChromaticities(header)) {
    const Imf::Chromaticities& xy = Imf::chromaticities(header);
    result.chromaticities = {xy.red.x,  xy.red.y,  xy.green.x, xy.green.y,
                             xy.blue.x, xy.blue.y, xy.white.x, xy.white.y};
  }
  std::map<std::string, Attribute> attributes;
  for (auto it = header.begin(); it != header.end(); ++it) {
    if (is_structural(it.name())) continue;
    copy_if_typed<std::string>(it.name(), it.attribute(), attributes);
    copy_if_typed<int>(it.name(), it.attribute(), attributes);
    copy_if_typed<float>(it.name(), it.attribute(), attributes);
    copy_if_typed<double>(it.name(), it.attribute(), attributes);
  }
  // What the first part says holds for the file.
  result.attributes.merge(attributes);
  for (IdNames& ids : id_names_of(header)) result.id_names.push_back(std::move(ids));
}

/// A channel of the image, and where in the file it is.
struct Source {
  ExrHeader::Channel channel;
  int part = 0;
  std::string name_in_part;
};

void add_channels(const std::filesystem::path& file, const Imf::Header& header, int part,
                  std::vector<Source>& sources) {
  std::set<std::string> taken;
  for (const Source& source : sources) taken.insert(source.channel.name);
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) {
      reject(file, std::string("subsampled channel ") + it.name(), "a value for every pixel");
    }
    std::string name = it.name();
    if (taken.contains(name)) {
      name = (header.hasName() ? header.name() : std::to_string(part)) + "." + name;
    }
    if (taken.contains(name)) reject(file, "channel " + name + " twice", "every channel once");
    sources.push_back({{name, type_name(it.channel().type)}, part, it.name()});
    if (sources.size() > kMaxChannels) reject(file, "more than 4096 channels", "at most 4096");
  }
}

// All parts as one image.
ExrHeader understood(const std::filesystem::path& file, const Imf::MultiPartInputFile& exr,
                     std::vector<Source>& sources) {
  ExrHeader result = windows_of(file, exr.header(0));
  result.part_count = exr.parts();
  result.has_named_parts = exr.header(0).hasName();
  for (int part = 0; part < exr.parts(); ++part) {
    const ExrHeader windows = windows_of(file, exr.header(part));
    if (windows.width != result.width || windows.height != result.height ||
        windows.data_origin != result.data_origin || windows.full_size != result.full_size) {
      reject(file, "parts of different sizes", "parts that make one image");
    }
    add_channels(file, exr.header(part), part, sources);
    add_attributes(exr.header(part), result);
  }
  if (sources.empty()) reject(file, "an EXR without channels", "at least one channel");
  if (std::int64_t{result.width} * result.height * static_cast<std::int64_t>(sources.size()) >
      kMaxValues) {
    reject(file, "more than 2^31 values", "at most 2^31 values, pixels times channels");
  }
  std::sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) {
    return channel_rank(a.channel.name) < channel_rank(b.channel.name);
  });
  for (const Source& source : sources) result.channels.push_back(source.channel);
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
      header = understood(path, *file_, sources);
      for (int part = 0; part < file_->parts(); ++part) {
        if (!file_->partComplete(part)) reject(path, "a truncated EXR", "a whole file");
      }
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
  std::vector<Source> sources;  ///< Of its channels, in their order.

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
  image.id_names = exr.header.id_names;
  for (const auto& channel : exr.header.channels) image.channels.push_back(channel.name);

  const std::size_t channels = image.channel_count();
  const std::size_t row_values = static_cast<std::size_t>(image.width) * channels;
  exr.translated([&] {
    image.pixels.reserve(row_values * static_cast<std::size_t>(image.height));
    std::vector<Imf::InputPart> parts;
    for (int part = 0; part < exr.header.part_count; ++part) parts.emplace_back(exr.file(), part);
    for (int begin = 0; begin < image.height; begin += kRowsAtATime) {
      const int rows = std::min(kRowsAtATime, image.height - begin);
      const std::size_t offset = row_values * static_cast<std::size_t>(begin);
      image.pixels.resize(offset + row_values * static_cast<std::size_t>(rows));
      std::vector<Imf::FrameBuffer> buffers(parts.size());
      for (std::size_t c = 0; c < channels; ++c) {
        const auto part = static_cast<std::size_t>(exr.sources[c].part);
        const Imath::V2i origin = parts[part].header().dataWindow().min;
        buffers[part].insert(
            exr.sources[c].name_in_part,
            Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + offset + c,
                             Imath::V2i(origin.x, origin.y + begin), image.width, rows,
                             channels * sizeof(float), row_values * sizeof(float)));
      }
      for (std::size_t part = 0; part < parts.size(); ++part) {
        const int first = parts[part].header().dataWindow().min.y + begin;
        parts[part].setFrameBuffer(buffers[part]);
        parts[part].readPixels(first, first + rows - 1);
      }
    }
  });
  return image;
}

}  // namespace abbe
