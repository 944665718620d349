#include "abbe/display/display.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/parallel.h"
#include "abbe/display/embedded_config.h"
#include "abbe/image/image_pair.h"
#include "abbe/image/raster/raster.h"

namespace OCIO = OCIO_NAMESPACE;

namespace abbe {
namespace {

constexpr double kMiddleGrey = 0.18;
// Auto exposure: where bright things go, and how far the mean may come from middle grey for it.
constexpr double kNearWhite = 0.95;
constexpr double kDarkerThanGrey_ev = 2.0, kBrighterThanGrey_ev = 0.75;

// Beyond this the matrices and curves of a view overflow to NaN; no display shows a difference.
constexpr float kLargestValue = 1e9f;

struct LoadedConfig {
  OCIO::ConstConfigRcPtr config;
  std::string where;  ///< For messages.
};

LoadedConfig load_file(const std::filesystem::path& file, const std::string& where) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw_input_error(where, "no such file", "an OCIO configuration");
  }
  try {
    OCIO::ConstConfigRcPtr config = OCIO::Config::CreateFromFile(file.c_str());
    config->validate();
    return {config, where};
  } catch (const OCIO::Exception& exception) {
    throw_input_error(where, exception.what(), "an OCIO configuration");
  }
}

LoadedConfig load_config(const DisplayOptions& options) {
  // Remarks on a configuration would go to stderr past the one place that prints.
  OCIO::SetLoggingLevel(OCIO::LOGGING_LEVEL_NONE);
  if (options.config) return load_file(*options.config, options.config->string());
  if (const char* variable = std::getenv("OCIO"); variable != nullptr && *variable != '\0') {
    return load_file(variable, std::string("$OCIO, ") + variable);
  }
  const std::filesystem::path folder = program_folder();
  for (const char* relative : {"../share/abbe/config", "../../config", "../config"}) {
    const std::filesystem::path file = folder / relative / "config.ocio";
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) return load_file(file, file.string());
  }
  std::istringstream text{embedded_config()};
  return {OCIO::Config::CreateFromStream(text), "the built-in OCIO configuration"};
}

// The names that `name_at` gives for 0 to count − 1.
template <typename NameAt>
std::vector<std::string> names_of(int count, const NameAt& name_at) {
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) names.emplace_back(name_at(i));
  return names;
}

void check_space(const LoadedConfig& loaded, const std::string& name) {
  const OCIO::Config& config = *loaded.config;
  if (config.getColorSpace(name.c_str())) return;
  constexpr auto kScene = OCIO::SEARCH_REFERENCE_SPACE_SCENE;
  constexpr auto kActive = OCIO::COLORSPACE_ACTIVE;
  throw_usage_error("color_space", "'" + name + "'", "a colour space of " + loaded.where,
                    names_of(config.getNumColorSpaces(kScene, kActive), [&](int i) {
                      return config.getColorSpaceNameByIndex(kScene, kActive, i);
                    }));
}

void check_display_and_view(const LoadedConfig& loaded, const std::string& display,
                            const std::string& view) {
  const OCIO::Config& config = *loaded.config;
  const auto displays =
      names_of(config.getNumDisplays(), [&](int i) { return config.getDisplay(i); });
  check_choice("display", display, "a display of " + loaded.where, displays);
  const auto views = names_of(config.getNumViews(display.c_str()),
                              [&](int i) { return config.getView(display.c_str(), i); });
  check_choice("view", view, "a view of " + display + " in " + loaded.where, views);
}

OCIO::ConstCPUProcessorRcPtr processor_of(const LoadedConfig& loaded,
                                          const OCIO::ConstTransformRcPtr& transform) {
  try {
    return loaded.config->getProcessor(transform)->getDefaultCPUProcessor();
  } catch (const OCIO::Exception& exception) {
    throw_input_error(loaded.where, exception.what(), "a configuration that can be applied");
  }
}

using RgbIndices = std::array<std::size_t, 3>;

float finite(float value) {
  return std::isnan(value) ? 0.0f : std::clamp(value, -kLargestValue, kLargestValue);
}

// Applies a processor to gain × RGB of `source`, row by row, into R, G, B of `target`.
void apply(const OCIO::CPUProcessor& processor, const Image& source, const RgbIndices& from,
           float gain, Image& target, const RgbIndices& to) {
  const auto width = static_cast<std::size_t>(source.width);
  const std::size_t source_channels = source.channel_count();
  const std::size_t target_channels = target.channel_count();
  parallel_for(0, static_cast<std::size_t>(source.height), 4, [&](std::size_t y) {
    std::vector<float> row(width * 3);
    const float* in = source.pixels.data() + y * width * source_channels;
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        row[x * 3 + c] = finite(gain * in[x * source_channels + from[c]]);
      }
    }
    OCIO::PackedImageDesc description(row.data(), source.width, 1, 3);
    processor.apply(description);
    float* out = target.pixels.data() + y * width * target_channels;
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) out[x * target_channels + to[c]] = row[x * 3 + c];
    }
  });
}

}  // namespace

Image to_display(const Image& scene_linear, const DisplayOptions& options) {
  const LoadedConfig loaded = load_config(options);
  check_space(loaded, options.source_space);
  check_display_and_view(loaded, options.display, options.view);
  const RgbIndices from = rgb_indices(scene_linear);

  const auto transform = OCIO::DisplayViewTransform::Create();
  transform->setSrc(options.source_space.c_str());
  transform->setDisplay(options.display.c_str());
  transform->setView(options.view.c_str());
  const auto processor = processor_of(loaded, transform);
  const double exposure_ev =
      options.auto_exposure ? auto_exposure_ev(scene_linear) : options.exposure_ev;

  Image display;
  display.width = scene_linear.width;
  display.height = scene_linear.height;
  display.data_origin = scene_linear.data_origin;
  display.full_size = scene_linear.full_size;
  display.channels = {"R", "G", "B"};
  display.attributes[kDisplayAttribute] = options.display;
  display.pixels.resize(static_cast<std::size_t>(display.width) *
                        static_cast<std::size_t>(display.height) * 3);
  apply(*processor, scene_linear, from, static_cast<float>(std::exp2(exposure_ev)), display,
        {0, 1, 2});
  return display;
}

void convert_space(Image& image, const std::string& from, const std::string& to,
                   const DisplayOptions& options, const std::string& layer) {
  const LoadedConfig loaded = load_config(options);
  check_space(loaded, from);
  check_space(loaded, to);
  const RgbIndices rgb = rgb_indices(image, layer);
  const auto transform = OCIO::ColorSpaceTransform::Create();
  transform->setSrc(from.c_str());
  transform->setDst(to.c_str());
  apply(*processor_of(loaded, transform), image, rgb, 1.0f, image, rgb);
}

std::vector<std::string> scene_linear_spaces(const DisplayOptions& options) {
  const LoadedConfig loaded = load_config(options);
  const OCIO::Config& config = *loaded.config;
  constexpr auto kScene = OCIO::SEARCH_REFERENCE_SPACE_SCENE;
  constexpr auto kActive = OCIO::COLORSPACE_ACTIVE;
  constexpr std::array<float, 3> kDim{0.02f, 0.05f, 0.11f};
  constexpr float kFactor = 8.0f;
  std::vector<std::string> spaces;
  for (int i = 0; i < config.getNumColorSpaces(kScene, kActive); ++i) {
    const char* name = config.getColorSpaceNameByIndex(kScene, kActive, i);
    const auto space = config.getColorSpace(name);
    if (!space || space->isData()) continue;
    const OCIO::ConstTransformRcPtr to = space->getTransform(OCIO::COLORSPACE_DIR_FROM_REFERENCE);
    const OCIO::ConstTransformRcPtr from = space->getTransform(OCIO::COLORSPACE_DIR_TO_REFERENCE);
    bool is_linear = true;
    if (to || from) {
      const auto processor = processor_of(loaded, to ? to : from);
      std::array<float, 3> dim = kDim, bright{}, black{};
      for (std::size_t c = 0; c < 3; ++c) bright[c] = kFactor * kDim[c];
      processor->applyRGB(dim.data());
      processor->applyRGB(bright.data());
      processor->applyRGB(black.data());
      for (std::size_t c = 0; c < 3; ++c) {
        is_linear = is_linear && std::abs(black[c]) < 1e-6f &&
                    std::abs(bright[c] - kFactor * dim[c]) < 1e-4f * std::abs(bright[c]) + 1e-6f;
      }
    }
    if (is_linear) spaces.emplace_back(name);
  }
  return spaces;
}

std::vector<bool> outside_gamut(const Image& scene_linear, const DisplayOptions& options) {
  const LoadedConfig loaded = load_config(options);
  check_space(loaded, options.source_space);
  check_display_and_view(loaded, options.display, options.view);
  std::string space =
      loaded.config->getDisplayViewColorSpaceName(options.display.c_str(), options.view.c_str());
  const auto known = loaded.config->getColorSpace(space.c_str());
  // A view that encodes nothing, as Raw, has the gamut of its display.
  if (space == OCIO::OCIO_VIEW_USE_DISPLAY_NAME || !known || known->isData()) {
    space = options.display;
  }
  const auto there = OCIO::ColorSpaceTransform::Create();
  there->setSrc(options.source_space.c_str());
  there->setDst(space.c_str());
  const auto back = OCIO::ColorSpaceTransform::Create();
  back->setSrc(space.c_str());
  back->setDst(options.source_space.c_str());
  const auto to_codes = processor_of(loaded, there);
  const auto from_codes = processor_of(loaded, back);

  const RgbIndices rgb = rgb_indices(scene_linear);
  const std::size_t channels = scene_linear.channel_count();
  std::vector<bool> outside(scene_linear.pixels.size() / channels);
  for (std::size_t p = 0; p < outside.size(); ++p) {
    std::array<float, 3> color{};
    for (std::size_t c = 0; c < 3; ++c)
      color[c] = finite(scene_linear.pixels[p * channels + rgb[c]]);
    const float largest = *std::max_element(color.begin(), color.end());
    if (!(largest > 0.0f)) continue;
    // Half of white: brightness is not what is asked for.
    for (float& value : color) value *= 0.5f / largest;
    std::array<float, 3> shown = color;
    to_codes->applyRGB(shown.data());
    for (float& code : shown) code = std::clamp(code, 0.0f, 1.0f);
    from_codes->applyRGB(shown.data());
    // OCIO's fast powers there and back lose 1e-4.
    constexpr float kTolerance = 2e-3f;
    for (std::size_t c = 0; c < 3; ++c) {
      if (std::abs(shown[c] - color[c]) > kTolerance) outside[p] = true;
    }
  }
  return outside;
}

double auto_exposure_ev(const Image& scene_linear) {
  const RgbIndices rgb = rgb_indices(scene_linear);
  const std::size_t channels = scene_linear.channel_count();
  const auto luminance = [&](std::size_t pixel) {
    const float* p = scene_linear.pixels.data() + pixel * channels;
    return 0.2126 * p[rgb[0]] + 0.7152 * p[rgb[1]] + 0.0722 * p[rgb[2]];
  };
  const std::size_t pixels = channels == 0 ? 0 : scene_linear.pixels.size() / channels;
  std::vector<double> lit;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double Y = luminance(i);
    if (std::isfinite(Y) && Y > 0.0) lit.push_back(Y);
  }
  std::sort(lit.begin(), lit.end());
  // What is black beside the rest has no logarithm to speak of: it must not drag the mean down.
  const double black = lit.empty() ? 0.0 : 1e-6 * lit.back();
  lit.erase(lit.begin(), std::upper_bound(lit.begin(), lit.end(), black));
  if (lit.empty()) return 0.0;
  double sum = 0.0;
  for (const double Y : lit) sum += std::log2(Y);
  const double grey_ev = std::log2(kMiddleGrey) - sum / static_cast<double>(lit.size());
  const std::size_t bright = (98 * (lit.size() - 1)) / 100;
  const double white_ev = std::log2(kNearWhite / lit[bright]);
  return std::clamp(white_ev, grey_ev - kDarkerThanGrey_ev, grey_ev + kBrighterThanGrey_ev);
}

}  // namespace abbe
