/// Writes down what happens to fans, when someone wants to know.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "abbe/integrate/integrator.h"
#include "abbe/integrate/record.h"
#include "abbe/integrate/surface/answer.h"

namespace abbe {

/// Appends records to a list; without a list it does nothing.
class FanRecorder {
 public:
  FanRecorder(const World& world, std::span<const CameraSample> samples,
              std::vector<FanRecord>* records)
      : world_(world), samples_(samples), records_(records) {}

  /// Lanes of a fan that left the scene.
  void miss(const Fan& fan, const FanList& list, const LaneMask& missed);
  /// Lanes that met a surface together, with how they arrived. Returns 1 + the number of the
  /// record, for children to refer to; 0 when nothing is recorded.
  std::uint32_t arrive(const Fan& fan, const SurfaceHit& hit, const LaneArray& throughput);
  /// Completes a record with what the surface does.
  void shade(std::uint32_t record_number, const MediumChange& change, const BoundaryRows& rows,
             const SurfaceHit& hit, const MaterialLanes& at, const SurfaceAnswer& answer);
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
