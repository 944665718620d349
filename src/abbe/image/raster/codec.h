/// OpenImageIO behind plain types. It stands on 250 libraries, which take a third of a second to
/// load: it lies in a module of its own, which is loaded when first needed.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace abbe {

/// How values lie in memory.
enum class RasterValue : std::uint8_t { Code8, Code16, Float };

/// What a file says about its pixels.
struct RasterHeader {
  int width = 0;
  int height = 0;
  int depth = 0;
  int orientation = 1;              ///< As Exif counts them: 1 is upright.
  bool is_floating_point = false;   ///< Numbers, not codes.
  bool has_8_bits = false;          ///< Codes of 8 bits.
  bool is_alpha_multiplied = true;  ///< Colours have been multiplied by alpha, if there is any.
  std::string format;               ///< As OpenImageIO calls it: "png", "hdr".
  std::vector<std::string> channels;
};

/// An image whose header has been read. Errors: std::runtime_error with the decoder's first line.
class RasterInput {
 public:
  virtual ~RasterInput() = default;
  virtual const RasterHeader& header() const = 0;
  /// All pixels, as floats.
  virtual void read(float* out) = 0;
  /// The rows [begin, end) of a file whose pixels lie in rows.
  virtual void read_rows(int begin, int end, RasterValue value, void* out) = 0;
};

/// RGB codes to be written.
struct RasterOutput {
  int width = 0;
  int height = 0;
  RasterValue value = RasterValue::Code8;  ///< Not Float.
  const void* codes = nullptr;             ///< width·height·3
  bool is_srgb = false;
};

/// Functions of the module: it shares no code with the library, only this file.
class RasterCodec {
 public:
  virtual ~RasterCodec() = default;
  /// Colours are not multiplied by alpha where the format lets them be. Errors: std::runtime_error.
  virtual std::unique_ptr<RasterInput> open(const std::string& file) const = 0;
  /// Null where OpenImageIO was built without the format. The bytes have to outlive the answer.
  virtual std::unique_ptr<RasterInput> open(std::span<const std::uint8_t> bytes,
                                            const std::string& format) const = 0;
  /// As "jpeg" or "tiff", without a date. Errors: std::runtime_error.
  virtual void write(const std::string& file, const std::string& format,
                     const RasterOutput& image) const = 0;
};

/// The module's only name, and what stands behind it.
inline constexpr const char* kRasterCodecSymbol = "abbe_raster_codec";
using RasterCodecFunction = const RasterCodec*();

/// Loaded by the first call, from the folder of libraries beside that of the program, from where
/// the linker's search path points, or from the build folder. Any thread.
/// Errors: input Error if it cannot be loaded.
const RasterCodec& raster_codec();

}  // namespace abbe
