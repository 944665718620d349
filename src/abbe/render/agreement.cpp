#include "abbe/render/agreement.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "abbe/base/error.h"
#include "abbe/render/render.h"
#include "abbe/scene/validation.h"

namespace abbe {
namespace {

void require_same(const char* part, const std::string& found, const std::string& expected) {
  if (found != expected) throw_usage_error(part, found, expected + ", as the settings have it");
}

std::string wavelengths_text(const WavelengthOptions& wavelengths) {
  if (!wavelengths.exact_nm.empty()) {
    return fmt::format("exactly {} nm", fmt::join(wavelengths.exact_nm, ", "));
  }
  return fmt::format("{} from {} to {} nm", wavelengths.count, wavelengths.range_min_nm,
                     wavelengths.range_max_nm);
}

void check_world(const WorldOptions& found, const WorldOptions& expected) {
  require_same("world.mode", mode_name(found.mode), mode_name(expected.mode));
  // The RGB modes know none of the rest.
  if (expected.mode != Mode::Spectral) return;
  require_same("world.wavelengths", wavelengths_text(found.wavelengths),
               wavelengths_text(expected.wavelengths));
  require_same("world.uplift", uplift_name(found.uplift), uplift_name(expected.uplift));
  require_same("world.frozen", "causes " + causes_text(found.frozen),
               "causes " + causes_text(expected.frozen));
}

std::string caustics_text(const CausticOptions& options) {
  if (!options.exact) return "off";
  return fmt::format("exact, {} inner reflections, cutoff {}", options.inner_reflections,
                     options.cutoff);
}

std::string window_text(const FilmOptions& options) {
  const Vec2i& size = options.full_size;
  const PixelRect crop = options.crop.value_or(PixelRect{0, 0, size.x, size.y});
  return fmt::format("{},{},{},{} of {}x{}", crop.x0, crop.y0, crop.x1, crop.y1, size.x, size.y);
}

std::string channels_text(const FilmOptions& options) {
  std::string text = options.bands ? "bands " + bands_text(*options.bands)
                                   : fmt::format("lines {}", fmt::join(options.lines_nm, ","));
  for (const AovChannel& aov : options.aovs) text += " " + aov.name;
  return text;
}

}  // namespace

void check_agreement(const LitWorld& world, const Camera& camera, const RenderSettings& settings,
                     const Film& film) {
  check_settings(settings);
  validate(camera, "camera");
  check_world(world.options, world_options(settings));
  require_same("world.caustics", caustics_text(world.caustic_options),
               caustics_text(caustic_options(settings)));
  const FilmOptions expected = film_options(settings);
  require_same("film.crop", window_text(film.options()), window_text(expected));
  require_same("film.channels", channels_text(film.options()), channels_text(expected));
  require_same("film.weight_magnitude", fmt::format("{}", film.options().weight_magnitude),
               fmt::format("{}", expected.weight_magnitude));
}

}  // namespace abbe
