/// Writes down what happens to fans, when someone wants to know.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "abbe/integrate/integrator.h"
#include "abbe/integrate/record.h"
#include "abbe/integrate/surface/interaction.h"
#include "abbe/integrate/surface/shading.h"

namespace abbe {

/// What a boundary does to the stack of media.
enum class Crossing : std::uint8_t {
  None,    ///< Opaque: there is no other side.
  Thin,    ///< A sheet in one medium.
  Enter,   ///< Into the material's medium.
  Leave,   ///< Out of it.
  Hidden,  ///< Out of a medium inside which another one has begun: no boundary for light.
};

/// Appends records to a list; without a list it does nothing.
class FanRecorder {
 public:
  FanRecorder(const World& world, std::span<const CameraSample> samples,
              std::vector<FanRecord>* records)
      : world_(world), samples_(samples), records_(records) {}

  bool is_on() const { return records_ != nullptr; }
  /// 1 + number of the last record, for children to refer to; 0 when nothing is recorded.
  std::uint32_t last() const { return is_on() ? static_cast<std::uint32_t>(records_->size()) : 0; }

  /// Lanes of a fan that left the scene.
  void miss(const Fan& fan, const FanList& list, const LaneMask& missed);
  /// Lanes that met a surface together, with how they arrived.
  void arrive(const Fan& fan, const LaneMask& lanes, std::uint32_t surface, bool front,
              const Interaction& at);
  /// Completes the record that arrive() began with what the surface does.
  void shade(Crossing crossing, const BoundaryRows& rows, const Interaction& at,
             const Shading& shading);
  /// Adds light from lamps to a record. `record` is 1 + its number, or 0.
  void add_direct_light(std::uint32_t record, std::span<const float> light,
                        std::span<const float> visibility);

 private:
  float wavelength_nm(const Fan& fan, int lane) const;

  const World& world_;
  std::span<const CameraSample> samples_;
  std::vector<FanRecord>* records_;
};

}  // namespace abbe
