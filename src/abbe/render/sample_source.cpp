#include "abbe/render/sample_source.h"

#include "abbe/math/random.h"
#include "abbe/render/sample_places.h"

namespace abbe {

SampleSource::SampleSource(const World& world, const Camera& camera, const RenderSettings& settings)
    : world_(world),
      settings_(settings),
      rays_(camera, settings.size),
      filter_(Filter::named(settings.filter)) {}

int SampleSource::set_of(std::uint32_t index) const {
  const WavelengthQuadrature* quadrature = world_.lanes.quadrature();
  if (quadrature == nullptr) return 0;
  return quadrature->set_of(placed_wavelength_shift(settings_, index));
}

WeightedSample SampleSource::sample(const Vec2i& pixel, std::uint32_t index,
                                    const std::optional<Vec2f>& offset_px) const {
  CameraSample sample;
  sample.set = set_of(index);
  const std::uint64_t at = number_in_sequence(settings_, index);
  sample.chance = {pixel_chance(pixel, static_cast<std::uint32_t>(at >> 32)),
                   static_cast<std::uint32_t>(at)};
  sample.u_fog = random_1d(sample.chance, kCameraPath, Purpose::Fog);
  const Vec2f u = random_2d(sample.chance, kCameraPath, Purpose::Film);
  const auto in_pixel = [this](float place_in_filter, int dimension) {
    return placed(place_in_filter, dimension, settings_.seed, settings_.samples_per_pixel);
  };
  FilterSample place = filter_.sample({in_pixel(u.x, 0), in_pixel(u.y, 1)});
  if (offset_px) place.offset_px = *offset_px;
  sample.offset_px = place.offset_px;
  rays_.aim(Vec2d(pixel) + 0.5 + Vec2d(place.offset_px), sample);
  return {sample, place.weight};
}

}  // namespace abbe
