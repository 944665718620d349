/// Triangles as they are seen from a place: the directions in which they lie.
#pragma once

#include "abbe/math/vec.h"

namespace abbe {

/// The solid angle of a triangle seen from the origin, in sr: 0 of one that is seen edge-on.
/// Shape:  corners at any distance > 0.
/// Source: van Oosterom & Strackee, The Solid Angle of a Plane Triangle, IEEE Trans. Biomed. Eng.
///         30(2), 1983.
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Below this triangles are better sampled by area: they subtend next to the same angle from all of
/// it, and what is left of α + β + γ − π has too few digits.
inline constexpr double kLeastSolidAngle_sr = 1e-5;

/// A direction among those in which a triangle is seen from the origin, evenly by solid angle.
/// Shape:  unit length. Domain: u in [0, 1]²; a solid angle of at least 1e-6 sr.
/// Source: Arvo, Stratified Sampling of Spherical Triangles, SIGGRAPH 1995.
Vec3d direction_to_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec2d& u);

}  // namespace abbe
