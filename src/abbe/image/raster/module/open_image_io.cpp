#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>
#include <utility>

#include "abbe/image/raster/codec.h"

namespace abbe {
namespace {

// Libraries report several lines; the first says what happened.
std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

OIIO::TypeDesc type_of(RasterValue value) {
  switch (value) {
    case RasterValue::Code8:
      return OIIO::TypeDesc::UINT8;
    case RasterValue::Code16:
      return OIIO::TypeDesc::UINT16;
    case RasterValue::Float:
      break;
  }
  return OIIO::TypeDesc::FLOAT;
}

// Alpha is coverage beside the colour; nothing may be multiplied into the colour.
OIIO::ImageSpec configuration() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  return config;
}

class Input final : public RasterInput {
 public:
  explicit Input(const std::string& file) {
    const OIIO::ImageSpec config = configuration();
    input_ = OIIO::ImageInput::open(file, &config);
    if (!input_) throw std::runtime_error(first_line(OIIO::geterror()));
    take_header(input_->spec());
  }

  Input(std::unique_ptr<OIIO::ImageInput> input, std::span<const std::uint8_t> bytes,
        const std::string& format)
      : memory_(const_cast<std::uint8_t*>(bytes.data()), bytes.size()), input_(std::move(input)) {
    OIIO::Filesystem::IOProxy* proxy = &memory_;
    OIIO::ImageSpec config = configuration();
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    OIIO::ImageSpec spec;
    check(input_->open("texture." + format, spec, config));
    take_header(spec);
  }

  const RasterHeader& header() const override { return header_; }

  void read(float* out) override {
    check(input_->read_image(0, 0, 0, channel_count(), OIIO::TypeDesc::FLOAT, out));
  }

  void read_rows(int begin, int end, RasterValue value, void* out) override {
    check(input_->read_scanlines(0, 0, begin, end, 0, 0, channel_count(), type_of(value), out));
  }

 private:
  int channel_count() const { return static_cast<int>(header_.channels.size()); }

  void check(bool is_done) const {
    if (!is_done) throw std::runtime_error(first_line(input_->geterror()));
  }

  void take_header(const OIIO::ImageSpec& spec) {
    header_.width = spec.width;
    header_.height = spec.height;
    header_.depth = spec.depth;
    header_.orientation = spec.get_int_attribute("Orientation", 1);
    header_.is_floating_point = spec.format.is_floating_point();
    header_.has_8_bits = spec.format == OIIO::TypeDesc::UINT8;
    header_.is_alpha_multiplied = spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    header_.format = input_->format_name();
    header_.channels = spec.channelnames;
  }

  RasterHeader header_;
  // Outlives the decoder that reads from it.
  OIIO::Filesystem::IOMemReader memory_{nullptr, 0};
  std::unique_ptr<OIIO::ImageInput> input_;
};

class Codec final : public RasterCodec {
 public:
  std::unique_ptr<RasterInput> open(const std::string& file) const override {
    return std::make_unique<Input>(file);
  }

  std::unique_ptr<RasterInput> open(std::span<const std::uint8_t> bytes,
                                    const std::string& format) const override {
    auto input = OIIO::ImageInput::create(format);
    if (!input) return nullptr;
    return std::make_unique<Input>(std::move(input), bytes, format);
  }

  void write(const std::string& file, const std::string& format,
             const RasterOutput& image) const override {
    const OIIO::TypeDesc type = type_of(image.value);
    OIIO::ImageSpec spec(image.width, image.height, 3, type);
    if (image.is_srgb) spec.attribute("oiio:ColorSpace", "sRGB");
    if (format == "jpeg") {
      spec.attribute("Compression", "jpeg:95");
      // Fringes are a pixel or two wide: halved chroma would wash them out.
      spec.attribute("jpeg:subsampling", "4:4:4");
    }
    // OpenImageIO would put the present time into a TIFF.
    if (format == "tiff") spec.attribute("DateTime", "");

    const auto output = OIIO::ImageOutput::create(format);
    if (!output) throw std::runtime_error(OIIO::geterror());
    if (!output->open(file, spec) || !output->write_image(type, image.codes) || !output->close()) {
      throw std::runtime_error(output->geterror());
    }
  }
};

}  // namespace
}  // namespace abbe

extern "C" __attribute__((visibility("default"))) const abbe::RasterCodec* abbe_raster_codec() {
  static const abbe::Codec codec;
  return &codec;
}
