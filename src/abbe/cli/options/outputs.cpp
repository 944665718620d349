#include "abbe/cli/options/outputs.h"

#include <algorithm>
#include <cctype>

#include "abbe/base/error.h"
#include "abbe/base/file.h"

namespace abbe {

OutputKind output_kind(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (suffix == ".exr") return OutputKind::Exr;
  for (const char* raster : {".png", ".jpg", ".jpeg", ".tif", ".tiff"}) {
    if (suffix == raster) return OutputKind::Raster;
  }
  throw_usage_error("-o", "\"" + file.string() + "\"", "a file name with a known suffix",
                    {".exr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"});
}

void check_outputs(const std::vector<std::filesystem::path>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    (void)output_kind(files[i]);
    for (std::size_t j = 0; j < i; ++j) {
      if (files[i].lexically_normal() == files[j].lexically_normal()) {
        throw_usage_error("-o", "\"" + files[i].string() + "\" twice", "each file once");
      }
    }
  }
  for (const std::filesystem::path& file : files) check_writable(file);
}

void check_display(const DisplayOptions& options) {
  Image image;
  image.width = image.height = 1;
  image.channels = {"R", "G", "B"};
  image.pixels = {0.18f, 0.18f, 0.18f};
  (void)to_display(image, options);
}

}  // namespace abbe
