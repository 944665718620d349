#include "abbe/cli/options/outputs.h"

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/image/channels.h"

namespace abbe {

const std::vector<std::string>& image_suffixes() {
  static const std::vector<std::string> suffixes{".exr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"};
  return suffixes;
}

OutputKind output_kind(const std::filesystem::path& file) {
  const std::vector<std::string>& known = image_suffixes();
  const auto suffix = std::find(known.begin(), known.end(), lower_case(file.extension().string()));
  if (suffix == known.end()) {
    throw_usage_error("-o", "\"" + file.string() + "\"", "a file name with a known suffix", known);
  }
  return suffix == known.begin() ? OutputKind::Exr : OutputKind::Raster;
}

Outputs sorted_outputs(const std::vector<std::string>& files) {
  Outputs outputs;
  for (const std::string& file : files) {
    (output_kind(file) == OutputKind::Exr ? outputs.exrs : outputs.rasters).emplace_back(file);
  }
  return outputs;
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
  (void)to_display(grey_pixel(), options);
}

}  // namespace abbe
