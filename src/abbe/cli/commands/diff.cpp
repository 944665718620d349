/// `abbe diff`: two images as numbers, and where they differ as a picture.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/describe/describe.h"
#include "abbe/cli/options/outputs.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/text.h"
#include "abbe/image/channels.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/metrics/heat_map.h"
#include "abbe/image/raster/raster.h"
#include "abbe/report/difference.h"
#include "abbe/session/color_spaces.h"

namespace abbe {
namespace {

struct DiffCommand {
  std::string image, reference, config, channels;
  std::vector<std::string> outputs, fails;
  std::string map;
  double map_max = 0.0;  // 0: by the metric.
  double exposure_ev = 0.0;
  ColorViewing options;
  bool as_json = false;
};

constexpr const char* kRasterSpace = "sRGB - Texture";

struct LoadedImage {
  Image image;
  std::string space;
};

LoadedImage load(const std::filesystem::path& file) {
  if (output_kind(file) == OutputKind::Exr) return {read_exr(file), space_of_file(file)};
  return {read_raster(file), kRasterSpace};
}

void keep_channels(Image& image, const std::vector<std::string>& names, const std::string& file) {
  std::vector<std::size_t> kept;
  for (const std::string& name : names) {
    kept.push_back(check_choice("--channels", name, "a channel of " + file, image.channels));
  }
  image.pixels = picked_values(image, kept);
  image.channels = names;
}

// R, G, B as the eye is to see them: linear Rec.709 at the exposure asked for.
Image linear_rec709(const LoadedImage& loaded, const DiffCommand& arguments) {
  Image rgb = loaded.image;
  keep_channels(rgb, {"R", "G", "B"}, "");
  DisplayOptions options;
  if (!arguments.config.empty()) options.config = arguments.config;
  if (loaded.space != kRenderSpace) convert_space(rgb, loaded.space, kRenderSpace, options);
  const auto gain = static_cast<float>(std::exp2(arguments.exposure_ev));
  for (float& value : rgb.pixels) value *= gain;
  return rgb;
}

Description described(const ChannelMetrics& metrics) {
  Description out;
  out["rmse"] = metrics.rmse;
  out["relative_mse"] = metrics.relative_mse;
  // JSON has no infinity: equal channels have no ratio.
  out["psnr_db"] =
      std::isfinite(metrics.psnr_db) ? Description(metrics.psnr_db) : Description(nullptr);
  out["max"] = metrics.max_abs;
  out["max_at"] = {metrics.max_x, metrics.max_y};
  if (metrics.non_finite > 0) out["non_finite"] = metrics.non_finite;
  return out;
}

Description described(const MapStatistics& statistics) {
  return {{"mean", statistics.mean},
          {"percentile_95", statistics.percentile_95},
          {"max", statistics.max}};
}

std::string limit_text(const Threshold& threshold) {
  return threshold.metric + (threshold.channel.empty() ? "" : "@" + threshold.channel);
}

Description described(const Difference& difference, const std::vector<Threshold>& thresholds,
                      bool& exceeded) {
  Description out;
  out["channels"] = Description::object();
  for (const ChannelMetrics& channel : difference.channels) {
    out["channels"][channel.channel] = described(channel);
  }
  out["all"] = described(difference.all);
  if (difference.color) out["color"] = described(*difference.color);
  if (difference.spectral) out["spectral"] = described(*difference.spectral);
  if (difference.delta_e2000) out["delta_e2000"] = described(*difference.delta_e2000);
  if (difference.delta_e_itp) out["delta_e_itp"] = described(*difference.delta_e_itp);
  if (difference.flip) out["flip"] = described(*difference.flip);
  for (const Threshold& threshold : thresholds) {
    const double value = value_of(threshold, difference);
    const bool is_past = is_exceeded(threshold, value);
    exceeded |= is_past;
    out["thresholds"].push_back(
        {{"metric", limit_text(threshold)},
         {"value", std::isfinite(value) ? Description(value) : Description(nullptr)},
         {"limit", threshold.limit},
         {"exceeded", is_past}});
  }
  return out;
}

std::string row_of(const ChannelMetrics& metrics) {
  std::string row = fmt::format(
      "{:<18} {:>11.4g} {:>11.4g} {:>9} {:>11.4g}", printable(metrics.channel), metrics.rmse,
      metrics.relative_mse,
      std::isfinite(metrics.psnr_db) ? fmt::format("{:.2f}", metrics.psnr_db) : std::string("inf"),
      metrics.max_abs);
  if (metrics.max_abs > 0.0) row += fmt::format(" at {},{}", metrics.max_x, metrics.max_y);
  if (metrics.non_finite > 0) row += fmt::format("  {} not finite", metrics.non_finite);
  return row + "\n";
}

std::string text_of(const Difference& difference, const std::vector<Threshold>& thresholds) {
  std::string text = fmt::format("{:<18} {:>11} {:>11} {:>9} {:>11}\n", "channel", "RMSE",
                                 "rel. MSE", "PSNR dB", "max");
  for (const ChannelMetrics& channel : difference.channels) text += row_of(channel);
  if (difference.spectral) text += row_of(*difference.spectral);
  if (difference.color) text += row_of(*difference.color);
  if (difference.channels.size() > 1) text += row_of(difference.all);
  if (difference.delta_e2000) {
    text +=
        fmt::format("\n{:<18} {:>11} {:>11} {:>9} {:>11}\n", "colour", "mean", "95 %", "", "max");
    const auto row = [&text](const char* name, const MapStatistics& statistics) {
      text += fmt::format("{:<18} {:>11.4g} {:>11.4g} {:>9} {:>11.4g}\n", name, statistics.mean,
                          statistics.percentile_95, "", statistics.max);
    };
    row("CIEDE2000", *difference.delta_e2000);
    row("Delta E ITP", *difference.delta_e_itp);
    row("FLIP", *difference.flip);
  }
  for (const Threshold& threshold : thresholds) {
    const double value = value_of(threshold, difference);
    text +=
        fmt::format("{} {} {:.6g}, limit {:.6g}\n", is_exceeded(threshold, value) ? "FAIL" : "pass",
                    limit_text(threshold), value, threshold.limit);
  }
  return text;
}

struct Map {
  std::vector<float> values;
  double full_scale = 1.0;
};

Map chosen_map(const DiffCommand& arguments, const Image& image, const Image& reference,
               const std::optional<ColorMaps>& maps) {
  std::string name = arguments.map;
  if (name.empty()) name = maps ? "flip" : "max";
  if (name != "max" && !maps) {
    throw_usage_error("--map", name + " of images without R, G and B", "max");
  }
  // Ten just noticeable differences are plainly different colours.
  Map map;
  if (name == "flip") {
    map = {maps->flip, 1.0};
  } else if (name == "de2000") {
    map = {maps->delta_e2000, 10.0};
  } else if (name == "deitp") {
    map = {maps->delta_e_itp, 10.0};
  } else {
    map.values = max_error_map(image, reference);
    double largest = 0.0;
    for (const float value : map.values) {
      if (std::isfinite(value)) largest = std::max(largest, double{value});
    }
    map.full_scale = largest > 0.0 ? largest : 1.0;
  }
  if (arguments.map_max > 0.0) map.full_scale = arguments.map_max;
  return map;
}

void write_maps(const DiffCommand& arguments, const Map& map, const Image& reference) {
  const auto [exrs, rasters] = sorted_outputs(arguments.outputs);
  for (const std::filesystem::path& file : rasters) {
    write_raster(file, heat_map(map.values, reference.width, reference.height, map.full_scale));
  }
  Image values = same_window(reference, {"Y"});
  values.pixels = map.values;
  for (const std::filesystem::path& file : exrs) write_exr(file, values, {});
}

ExitCode run_diff(const DiffCommand& arguments) {
  std::vector<Threshold> thresholds;
  for (const std::string& text : arguments.fails) thresholds.push_back(parse_threshold(text));
  if (!arguments.map.empty()) {
    check_choice("--map", arguments.map, "a map", {"flip", "de2000", "deitp", "max"});
  }
  const auto check_positive = [](const char* option, double value) {
    if (!(value > 0.0)) throw_usage_error(option, fmt::format("{:g}", value), "a number above 0");
  };
  check_positive("--white", arguments.options.white_cd_per_m2);
  check_positive("--ppd", arguments.options.pixels_per_degree);
  if (arguments.options.pixels_per_degree > 1000.0) {
    throw_usage_error("--ppd", fmt::format("{:g}", arguments.options.pixels_per_degree),
                      "at most 1000 pixels per degree");
  }
  if (arguments.map_max < 0.0) check_positive("--map-max", arguments.map_max);
  check_outputs({arguments.outputs.begin(), arguments.outputs.end()});
  for (const std::string& file : arguments.outputs) {
    check_apart({{"-o", file}}, {{"A", arguments.image}, {"B", arguments.reference}});
  }

  if (output_kind(arguments.image) != output_kind(arguments.reference)) {
    throw_usage_error("abbe diff", "a scene-linear and a display-encoded image",
                      "two images of one kind; abbe display makes one of the other");
  }
  LoadedImage image = load(arguments.image);
  LoadedImage reference = load(arguments.reference);
  if (!arguments.channels.empty()) {
    keep_channels(image.image, parse_names(arguments.channels), arguments.image);
    keep_channels(reference.image, parse_names(arguments.channels), arguments.reference);
  }
  std::optional<ColorMaps> maps;
  try {
    // Channels first: what is missing in one of the images is to be said, not passed over.
    (void)difference_of(image.image, reference.image, std::nullopt);
  } catch (const Error& error) {
    ErrorDetail detail = error.detail();
    if (detail.where.empty()) detail.where = arguments.image + " against " + arguments.reference;
    throw Error(std::move(detail));
  }
  if (rgb_channels(image.image)) {
    maps = color_maps(linear_rec709(image, arguments), linear_rec709(reference, arguments),
                      arguments.options);
  }
  const Difference difference = difference_of(image.image, reference.image, maps);
  bool exceeded = false;
  const Description description = described(difference, thresholds, exceeded);
  if (!arguments.outputs.empty()) {
    write_maps(arguments, chosen_map(arguments, image.image, reference.image, maps),
               reference.image);
  }
  print(arguments.as_json ? json_text(description) : text_of(difference, thresholds));
  return exceeded ? ExitCode::Exceeded : ExitCode::Done;
}

}  // namespace

void add_diff_command(CLI::App& program, ExitCode& code) {
  CLI::App& command = *program.add_subcommand("diff", "Compare two images in numbers");
  const auto arguments = std::make_shared<DiffCommand>();
  command.add_option("A", arguments->image, "image, .exr, .png, .jpg or .tif")->required();
  command.add_option("B", arguments->reference, "the reference it is held against")->required();
  add_shown(command, "-o,--output", arguments->outputs, "FILE",
            "map of the differences, .png coloured or .exr as numbers; repeatable")
      ->allow_extra_args(false);
  add_shown(command, "--fail", arguments->fails, "METRIC=VALUE",
            "exit with 1 when a metric is past a value (psnr: below it), for all channels or "
            "METRIC@CHANNEL: " +
                fmt::format("{}", fmt::join(diff_metric_names(), ", ")) + "; repeatable")
      ->allow_extra_args(false);
  add_shown(command, "--channels", arguments->channels, "LIST",
            "compare only these channels (default: all; they must be the same in both)");
  add_shown(command, "--map", arguments->map, "NAME",
            "what the map shows: flip, de2000, deitp or max (default: flip, max without RGB)");
  add_number(command, "--map-max", arguments->map_max, "X",
             "value of the map's brightest colour (default: flip 1, de2000 and deitp 10, max the "
             "largest)");
  add_number(command, "--exposure", arguments->exposure_ev, "EV",
             "brightens both by EV stops before their colours are compared (default: 0)");
  add_number(command, "--ppd", arguments->options.pixels_per_degree, "N",
             "pixels per degree of the screen, for FLIP (default: 67)");
  add_number(command, "--white", arguments->options.white_cd_per_m2, "CD",
             "luminance of 1, 1, 1 in cd/m2, for Delta E ITP (default: 100)");
  add_shown(command, "--config", arguments->config, "FILE",
            "OpenColorIO configuration that knows the images' spaces (default: $OCIO, then abbe's "
            "own)");
  command.add_flag("--json", arguments->as_json, "print JSON");
  command.callback([arguments, &code] { code = run_diff(*arguments); });
}

}  // namespace abbe
