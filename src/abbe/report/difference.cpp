#include "abbe/report/difference.h"

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/image_pair.h"

namespace abbe {
namespace {

void check_alike(const Image& image, const Image& reference) {
  check_same_size(image, reference);
  if (image.data_origin != reference.data_origin || image.full_size != reference.full_size) {
    throw_input_error("", "another crop", "the reference's place in the full image");
  }
  const auto check_missing = [](const Image& in, const Image& of, const char* whose) {
    std::vector<std::string> missing;
    for (const std::string& channel : of.channels) {
      if (!in.channel_index(channel)) missing.push_back(channel);
    }
    if (missing.empty()) return;
    constexpr std::size_t kMaxNames = 8;
    std::string found = std::string(whose) + " without ";
    for (std::size_t i = 0; i < std::min(missing.size(), kMaxNames); ++i) {
      found += (i > 0 ? ", " : "") + missing[i];
    }
    if (missing.size() > kMaxNames) {
      found += " and " + std::to_string(missing.size() - kMaxNames) + " more";
    }
    throw_input_error("", found, "the same channels in both; `channels` compares a part");
  };
  check_missing(image, reference, "a first image");
  check_missing(reference, image, "a second image");
}

const ChannelMetrics& channel_of(const Threshold& threshold, const Difference& difference) {
  const std::string& name = threshold.channel;
  if (name.empty()) return difference.all;
  if (name == "color" && difference.color) return *difference.color;
  if (name == "spectral" && difference.spectral) return *difference.spectral;
  std::vector<std::string> names;
  for (const ChannelMetrics& channel : difference.channels) {
    if (channel.channel == name) return channel;
    names.push_back(channel.channel);
  }
  if (difference.color) names.emplace_back("color");
  if (difference.spectral) names.emplace_back("spectral");
  throw_usage_error("fail", "channel \"" + name + "\"", "a channel of the images", names);
}

}  // namespace

Difference difference_of(const Image& image, const Image& reference,
                         const std::optional<ColorMaps>& maps) {
  check_alike(image, reference);
  Difference difference;
  difference.channels = image_metrics(image, reference);
  difference.all = combined_metrics(difference.channels, "all");
  std::vector<ChannelMetrics> color, spectral;
  for (const ChannelMetrics& channel : difference.channels) {
    const std::string& name = channel.channel;
    if (name == "R" || name == "G" || name == "B") color.push_back(channel);
    if (spectral_channel_wavelength_nm(name)) spectral.push_back(channel);
  }
  if (color.size() == 3) difference.color = combined_metrics(color, "color");
  if (!spectral.empty()) difference.spectral = combined_metrics(spectral, "spectral");
  if (maps) {
    difference.delta_e2000 = map_statistics(maps->delta_e2000);
    difference.delta_e_itp = map_statistics(maps->delta_e_itp);
    difference.flip = map_statistics(maps->flip);
  }
  return difference;
}

std::vector<std::string> diff_metric_names() {
  return {"rmse",       "relmse", "psnr",      "max",  "nonfinite", "de2000",
          "de2000.max", "deitp",  "deitp.max", "flip", "flip.max"};
}

Threshold parse_threshold(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  Threshold threshold;
  const std::string name = text.substr(0, equals);
  const std::size_t at = name.find('@');
  threshold.metric = name.substr(0, at);
  if (at != std::string::npos) threshold.channel = name.substr(at + 1);
  const std::vector<std::string> names = diff_metric_names();
  if (std::find(names.begin(), names.end(), threshold.metric) == names.end()) {
    throw_usage_error("fail", "\"" + text + "\"", "METRIC=VALUE or METRIC@CHANNEL=VALUE", names);
  }
  const auto limit =
      equals == std::string::npos ? std::nullopt : number_of(text.substr(equals + 1));
  if (!limit) throw_usage_error("fail", "\"" + text + "\"", "METRIC=VALUE with a number");
  const bool is_of_colors =
      threshold.metric.starts_with("de") || threshold.metric.starts_with("flip");
  if (is_of_colors && !threshold.channel.empty()) {
    throw_usage_error("fail", "\"" + text + "\"",
                      threshold.metric + " without a channel: it is of all three colours");
  }
  threshold.limit = *limit;
  return threshold;
}

double value_of(const Threshold& threshold, const Difference& difference) {
  const std::string& metric = threshold.metric;
  const auto of_colors = [&metric](const std::optional<MapStatistics>& statistics) {
    if (!statistics) {
      throw_usage_error("fail", metric + " of images without R, G and B",
                        "a metric that works channel by channel",
                        {"rmse", "relmse", "psnr", "max", "nonfinite"});
    }
    return metric.ends_with(".max") ? statistics->max : statistics->mean;
  };
  if (metric.starts_with("de2000")) return of_colors(difference.delta_e2000);
  if (metric.starts_with("deitp")) return of_colors(difference.delta_e_itp);
  if (metric.starts_with("flip")) return of_colors(difference.flip);
  const ChannelMetrics& channel = channel_of(threshold, difference);
  if (metric == "rmse") return channel.rmse;
  if (metric == "relmse") return channel.relative_mse;
  if (metric == "psnr") return channel.psnr_db;
  if (metric == "nonfinite") return static_cast<double>(channel.non_finite);
  return channel.max_abs;
}

bool is_exceeded(const Threshold& threshold, double value) {
  if (threshold.metric == "psnr") return !(value >= threshold.limit);
  return !(value <= threshold.limit);
}

}  // namespace abbe
