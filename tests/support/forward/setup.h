/// Optical setups: bodies with flat faces, one lamp, one screen. The same setup goes to abbe as
/// glTF (setup_gltf.h) and to the forward reference (photons.h), which share nothing else.
///
/// Lengths are metres. Corners are what a float holds, as they are in the glTF.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe::test {

/// n² = 1 + Σ B λ²/(λ² − C), λ in µm; `constant` where there are no terms.
struct GlassIndex {
  double constant = 1.5;
  std::vector<double> B = {}, C = {};

  double at(double wavelength_nm) const;
};

/// N-BK7 and N-SF11 as Schott states them, water and diamond at about 550 nm.
GlassIndex n_bk7();
GlassIndex n_sf11();
inline constexpr double kWater = 1.333;
inline constexpr double kDiamond = 2.42;

/// Where dielectrics overlap the one of higher priority owns the space, then the smaller one.
struct Dielectric {
  GlassIndex index;
  double absorption_per_m = 0.0;
  int priority = 0;
};
/// Reflects everything, or as a metal of index n + ik.
struct Mirror {
  std::optional<std::complex<double>> index = {};
};
/// A matte wall of albedo 0.8.
struct Wall {};
using Matter = std::variant<Dielectric, Mirror, Wall>;

/// A convex polygon, counterclockwise seen from outside.
using FlatFace = std::vector<Vec3d>;
using FlatFaces = std::vector<FlatFace>;

/// Domain: the faces of a dielectric enclose it.
struct FlatBody {
  std::string name;
  FlatFaces faces;
  Matter matter;
};

/// A box; what its `outline` (counterclockwise) sweeps along Z from z0 to z1.
FlatFaces box(const Vec3d& center, const Vec3d& half);
FlatFaces swept(const std::vector<Vec2d>& outline, double z0, double z1);
/// What all planes n·x ≤ w have behind them.
FlatFaces convex(const std::vector<Vec4d>& planes);
/// A cup, open towards +Y: a box of `half` about `center` with a cavity of `inner` half widths in X
/// and Z down to the height `bottom`.
FlatFaces cup(const Vec3d& center, const Vec3d& half, const Vec2d& inner, double bottom);
/// The same faces seen from the other side; moved; of two bodies.
FlatFaces turned_over(FlatFaces faces);
FlatFaces moved(const Mat4d& by, FlatFaces faces);
FlatFaces joined(FlatFaces faces, const FlatFaces& more);

/// Centre and half axes; faces x × y.
struct Rectangle {
  Vec3d center{0.0}, x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0};

  Vec3d normal() const { return glm::normalize(glm::cross(x, y)); }
  double area() const { return 4.0 * glm::length(glm::cross(x, y)); }
  FlatFace face() const;
};

enum class LampKind { Directional, Point, Spot };

/// Of irradiance 1 at right angles, or of intensity 1.
struct SetupLamp {
  LampKind kind = LampKind::Directional;
  Vec3d position{0.0};             ///< Of point and spot; it stands in air.
  Vec3d direction{1.0, 0.0, 0.0};  ///< Of directional and spot.
  double inner_cone_rad = 0.0, outer_cone_rad = 0.5;
};

struct OpticalSetup {
  std::string name;
  std::vector<FlatBody> bodies;
  SetupLamp lamp;
  Rectangle receiver;   ///< On a wall. Its front is what is measured.
  Vec2i cells{2, 2};    ///< Of the receiver, rows from +y to −y.
  double eye_m = 0.01;  ///< Height over the receiver from which a camera sees it, through air.
  int samples = 16;     ///< Camera samples a cell that its edges of light ask for.
  std::uint64_t photons = 100000;  ///< With which the reference errs by 0.3 % a cell, about.
  Rectangle aim;      ///< All light that matters comes from the lamp through here first.
  double unit = 1.0;  ///< Irradiance that figures are stated in.

  /// Rounds the corners to floats.
  void add(const std::string& body, const FlatFaces& faces, const Matter& matter);
};

}  // namespace abbe::test
