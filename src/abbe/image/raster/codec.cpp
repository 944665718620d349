#include "abbe/image/raster/codec.h"

#include <dlfcn.h>

#include <array>
#include <filesystem>

#include "abbe/base/error.h"
#include "abbe/base/file.h"

namespace abbe {
namespace {

constexpr const char* kFile = ABBE_RASTER_MODULE_FILE;

[[noreturn]] void reject(const std::string& found) {
  throw_input_error(kFile, found,
                    std::string("the module that reads and writes images, in ") +
                        (program_folder() / ABBE_RASTER_MODULE_FOLDER).lexically_normal().string() +
                        " or on the library path");
}

const RasterCodec* load() {
  const std::array<std::filesystem::path, 3> places{
      program_folder() / ABBE_RASTER_MODULE_FOLDER / kFile, kFile, ABBE_RASTER_MODULE_BUILT};
  std::string found = "no such file";
  for (const std::filesystem::path& place : places) {
    std::error_code ignored;
    const bool is_searched_for = !place.has_parent_path();
    if (!is_searched_for && !std::filesystem::exists(place, ignored)) continue;
    // Never closed: OpenImageIO keeps threads and what threads destroy at their end.
    void* module = dlopen(place.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr) {
      const char* reason = dlerror();
      // That nothing lies where the linker searches is no news beside what is wrong with a file.
      if (!is_searched_for && reason != nullptr) found = reason;
      continue;
    }
    auto* codec = reinterpret_cast<RasterCodecFunction*>(dlsym(module, kRasterCodecSymbol));
    if (codec != nullptr) return codec();
    found = place.string() + " without " + kRasterCodecSymbol;
  }
  reject(found);
}

}  // namespace

const RasterCodec& raster_codec() {
  static const RasterCodec* const codec = load();
  return *codec;
}

}  // namespace abbe
