// Names of spectral channels, written and read by hand: printf and strtod obey the locale.
#include <cmath>
#include <cstdint>
#include <string_view>

#include "abbe/base/text.h"
#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

constexpr std::string_view kEmissive = "S0.";
constexpr std::string_view kReflective = "T.";
constexpr std::string_view kSuffix = "nm";

std::string name_of(std::string_view prefix, double wavelength_nm) {
  const auto millionths = static_cast<std::int64_t>(std::llround(wavelength_nm * 1e6));
  std::string decimals = std::to_string(millionths % 1'000'000);
  decimals.insert(0, 6 - decimals.size(), '0');
  return std::string(prefix) + std::to_string(millionths / 1'000'000) + "," + decimals +
         std::string(kSuffix);
}

std::optional<double> wavelength_in(std::string_view text, std::string_view prefix) {
  if (!text.starts_with(prefix) || !text.ends_with(kSuffix)) return std::nullopt;
  text.remove_prefix(prefix.size());
  if (text.size() <= kSuffix.size()) return std::nullopt;
  text.remove_suffix(kSuffix.size());

  std::string with_point(text);
  const std::size_t comma = with_point.find(',');
  if (comma != std::string::npos) with_point[comma] = '.';
  if (with_point.front() == '-' || (comma == std::string::npos && text.find('.') != text.npos)) {
    return std::nullopt;
  }
  return number_of(with_point);
}

}  // namespace

std::string spectral_channel_name(double wavelength_nm) {
  return name_of(kEmissive, wavelength_nm);
}

std::optional<double> spectral_channel_wavelength_nm(const std::string& channel) {
  return wavelength_in(channel, kEmissive);
}

std::string reflective_channel_name(double wavelength_nm) {
  return name_of(kReflective, wavelength_nm);
}

std::optional<double> reflective_channel_wavelength_nm(const std::string& channel) {
  return wavelength_in(channel, kReflective);
}

}  // namespace abbe
