#include "abbe/cli/options/fields.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace abbe {
namespace {

struct Field {
  std::string_view name, option;
};

constexpr std::array<Field, 45> kFields{{{"accelerator", "--accel"},
                                         {"adaptation", "--adaptation"},
                                         {"animation", "--animation"},
                                         {"aovs", "--aov"},
                                         {"bands", "--bands"},
                                         {"camera", "--camera"},
                                         {"caustics", "--caustics"},
                                         {"channels", "--channels"},
                                         {"color_space", "--colorspace"},
                                         {"compression", "--compression"},
                                         {"crop", "--crop"},
                                         {"cutoff", "--cutoff"},
                                         {"display", "--display"},
                                         {"emissive_light", "--emissive-light"},
                                         {"entries", "NAME"},
                                         {"environment", "--environment"},
                                         {"environment_rotation_deg", "--environment-rotation"},
                                         {"environment_scale", "--environment-scale"},
                                         {"fail", "--fail"},
                                         {"filter", "--filter"},
                                         {"frozen", "--freeze"},
                                         {"inner_reflections", "--chain"},
                                         {"lamp", "--lamp"},
                                         {"light", "--light"},
                                         {"max_depth", "--depth"},
                                         {"mode", "--mode"},
                                         {"noise", "--noise"},
                                         {"noise_exposure_ev", "--exposure"},
                                         {"observer", "--observer"},
                                         {"range_nm", "--range"},
                                         {"wavelengths.range_min_nm", "--range"},
                                         {"rig", "--rig"},
                                         {"rig_time_s", "--rig-time"},
                                         {"samples_per_pixel", "--spp"},
                                         {"scene", "--scene"},
                                         {"size", "--size"},
                                         {"threads", "--threads"},
                                         {"time_s", "--time"},
                                         {"tile_size", "--tiles"},
                                         {"uplift", "--uplift"},
                                         {"variant", "--variant"},
                                         {"view", "--view"},
                                         {"wavelengths.count", "--wavelengths"},
                                         {"wavelengths.exact_nm", "--lines"},
                                         {"white", "--white"}}};

std::string option_of(const std::string& field) {
  const auto* found = std::find_if(kFields.begin(), kFields.end(),
                                   [&](const Field& known) { return known.name == field; });
  return found == kFields.end() ? field : std::string(found->option);
}

// Back quotes around a field go with its name.
std::string with_options(const std::string& text) {
  std::string result;
  std::size_t at = 0;
  while (true) {
    const std::size_t open = text.find('`', at);
    const std::size_t close = open == std::string::npos ? open : text.find('`', open + 1);
    if (close == std::string::npos) return result + text.substr(at);
    const std::string field = text.substr(open + 1, close - open - 1);
    const std::string option = option_of(field);
    // What is no field may end where one begins.
    const bool is_field = option != field;
    result += text.substr(at, open - at) + (is_field ? option : "`" + field);
    at = is_field ? close + 1 : close;
  }
}

}  // namespace

Error with_options(const Error& error) {
  ErrorDetail detail = error.detail();
  if (detail.kind == ErrorKind::Usage) detail.where = option_of(detail.where);
  detail.found = with_options(detail.found);
  detail.expected = with_options(detail.expected);
  return Error(std::move(detail));
}

}  // namespace abbe
