#include "abbe/session/spectra_hash.h"

#include <fmt/format.h>

#include "abbe/base/constants.h"
#include "abbe/base/file.h"

namespace abbe {
namespace {

class Hash {
 public:
  void add(double value) { hash_ = hash_bytes(&value, sizeof value, hash_); }

  void add(const Spectrum& spectrum) {
    add_over_range([&spectrum](double nm) { return spectrum.value(nm); });
    for (const double nm : spectrum.table_points_nm()) {
      add(nm);
      add(spectrum.value(nm));
    }
    for (const SpectralLine& line : spectrum.lines()) {
      add(line.wavelength_nm);
      add(line.strength);
    }
  }
  void add(const NamedSpectrum& named) { add(named.spectrum); }
  void add(const SpectralEmission& emission) { add(emission.spectrum); }
  void add(const Conductor& conductor) {
    add(conductor.n);
    add(conductor.k);
  }
  void add(const Observer& observer) {
    for (const Spectrum* curve : {&observer.x_bar, &observer.y_bar, &observer.z_bar}) add(*curve);
    for (int i = 0; i < 9; ++i) add(observer.responses_to_xyz[i / 3][i % 3]);
  }
  template <typename T>
  void add(const std::optional<T>& value) {
    if (value) add(*value);
  }
  /// An index by its id; one that a scene has written is in the hash of its file.
  void add_index(const std::string& id, const Dispersion& index) {
    if (!id.empty()) add_over_range([&index](double nm) { return refractive_index(index, nm); });
  }

  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  template <typename F>
  void add_over_range(const F& value) {
    for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 1.0) add(value(nm));
  }

  std::uint64_t hash_ = hash_bytes(nullptr, 0);
};

}  // namespace

std::string spectra_hash(const Scene& scene, const DevelopmentOptions& development,
                         const Standards& standards) {
  Hash hash;
  hash.add(standards.observer);
  hash.add(standards.d65);
  hash.add(development.observer.value_or(standards.observer));
  const White white = development.white.value_or(White{"", {{standards.d65, 1.0}}, {}});
  for (const auto& [lamp, share] : white.lamps) {
    hash.add(lamp);
    hash.add(share);
  }
  for (const Light& light : scene.lights) hash.add(light.spectrum);
  for (const Material& material : scene.materials) {
    hash.add(material.reflectance);
    hash.add(material.emission);
    hash.add(material.absorption_per_m);
    hash.add(material.conductor);
    hash.add_index(material.index_id, material.index);
    if (material.film) hash.add_index(material.film->index_id, material.film->index);
  }
  if (scene.ambient) hash.add(scene.ambient->spectrum);
  if (scene.environment) hash.add(scene.environment->spectrum);
  if (scene.fog) {
    const auto* albedo = std::get_if<Spectrum>(&scene.fog->albedo);
    if (albedo != nullptr) hash.add(*albedo);
  }
  return hash.text();
}

}  // namespace abbe
