/// Scenes made in code, for tests that need a closed form to compare with.
#pragma once

#include <glm/trigonometric.hpp>
#include <string>
#include <vector>

#include "abbe/load/spectra/catalogue.h"
#include "abbe/render/render.h"
#include "abbe/scene/scene.h"
#include "abbe/world/world.h"

namespace abbe::test {

/// The catalogue of the source tree.
const Catalogue& catalogue();

Mat4d translation(const Vec3d& t);
/// Rotation about an axis, in degrees, right-handed.
Mat4d rotation(const Vec3d& axis, double angle_deg);

/// A material that only emits RGB (cd/m²): black, without Fresnel reflection.
Material emitter(const Vec3f& emissive_rec709);
/// A matte reflectance without Fresnel reflection (index 1).
Material matte(const Vec3f& base_color_rec709);
/// Clear glass of a catalogue id, or of a constant index.
Material glass(const std::string& id);
Material glass(double index);
Material mirror(const std::string& conductor_id);

/// Adds a material, an instance; return their numbers.
std::uint32_t add(Scene& scene, Material material);
void add_shape(Scene& scene, Shape shape, std::uint32_t material, const Mat4d& to_world);
void add_sphere(Scene& scene, std::uint32_t material, const Vec3d& center, double radius_m);
/// A box as an exact polyhedron; `to_world` places its centre.
void add_box(Scene& scene, std::uint32_t material, const Vec3d& half_m, const Mat4d& to_world);
/// The same box as twelve triangles.
void add_box_mesh(Scene& scene, std::uint32_t material, const Vec3d& half_m, const Mat4d& to_world);
/// A mesh, of a material.
void add_mesh(Scene& scene, Mesh mesh, std::uint32_t material, const Mat4d& to_world);
/// A square in the XY plane of `to_world`, facing +Z.
void add_square(Scene& scene, std::uint32_t material, double half_m, const Mat4d& to_world);
/// A prism whose apex edge is the Y axis of `to_world`; its cross section in the XZ plane opens
/// towards −X, with the outward normals of its faces at ±(90° − apex/2) from +X.
void add_prism(Scene& scene, std::uint32_t material, double apex_deg, double side_m,
               const Mat4d& to_world);

Light point_light(const Vec3d& position, double candela);
Light directional_light(const Vec3d& towards, double lux);
Camera orthographic_camera(const Vec3d& eye, const Vec3d& target, double half_width_m,
                           double half_height_m);
Camera perspective_camera(const Vec3d& eye, const Vec3d& target, double yfov_deg);

/// A world made for the settings' mode and wavelengths.
LitWorld make_world(const Scene& scene, const RenderSettings& settings);
/// A render with the image that its film develops to.
struct Rendered : RenderResult {
  Image image;
};
Rendered render(const LitWorld& world, const Camera& camera, const RenderSettings& settings);
/// Renders with the scene's first camera.
Rendered render(const Scene& scene, const RenderSettings& settings);
/// Value of a channel at a pixel. Fails the test when there is no such channel.
float pixel(const Image& image, int x, int y, const std::string& channel);

/// Small settings for tests: 8×8, one sample, a box filter.
RenderSettings small_settings();

}  // namespace abbe::test
