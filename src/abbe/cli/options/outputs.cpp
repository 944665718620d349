#include "abbe/cli/options/outputs.h"

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/image/channels.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

// Links and different ways to write a path included.
bool are_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  return fs::weakly_canonical(fs::absolute(a), error) ==
         fs::weakly_canonical(fs::absolute(b), error);
}

}  // namespace

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
      if (are_same(files[i], files[j])) {
        throw_usage_error("-o", "\"" + files[i].string() + "\" twice", "each file once");
      }
    }
  }
  for (const std::filesystem::path& file : files) check_writable(file);
}

void check_apart(const std::vector<NamedFile>& written, const std::vector<NamedFile>& read) {
  const auto check = [](const NamedFile& a, const NamedFile& b) {
    if (a.file.empty() || b.file.empty() || !are_same(a.file, b.file)) return;
    throw_usage_error(a.option, "\"" + a.file.string() + "\", the file of " + b.option, "another");
  };
  for (std::size_t i = 0; i < written.size(); ++i) {
    for (const NamedFile& file : read) check(written[i], file);
    for (std::size_t j = 0; j < i; ++j) check(written[i], written[j]);
  }
}

void check_display(const DisplayOptions& options) {
  (void)to_display(grey_pixel(), options);
}

}  // namespace abbe
