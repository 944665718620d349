#include "abbe/world/world.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "abbe/accel/instances/bounds.h"
#include "abbe/base/constants.h"
#include "abbe/world/emitters.h"

namespace abbe {
namespace {

// The transmittance of a medium at the depth of mean absorption.
Spectrum transmittance(const Spectrum& absorption_per_m) {
  const double depth_m = (kRangeMax_nm - kRangeMin_nm) / integral(absorption_per_m);
  const std::span<const double> nm = absorption_per_m.table_points_nm();
  if (nm.empty() || !std::isfinite(depth_m)) return Spectrum::constant(1.0);
  std::vector<double> values;
  for (const double at_nm : nm)
    values.push_back(std::exp(-absorption_per_m.value(at_nm) * depth_m));
  return Spectrum::tabulated({nm.begin(), nm.end()}, std::move(values), OutsideTable::Clamp);
}

// The reflectances and transmittances of a scene that act as spectra and were given as such; what
// RGB is uplifted to is smooth.
std::vector<Spectrum> filter_spectra(const Scene& scene, const CauseSet& frozen) {
  std::vector<Spectrum> filters;
  for (const Material& material : scene.materials) {
    if (material.reflectance && !frozen.contains(Cause::Reflectances)) {
      filters.push_back(material.reflectance->spectrum);
    }
    if (material.absorption_per_m && !frozen.contains(Cause::Absorption)) {
      filters.push_back(transmittance(*material.absorption_per_m));
    }
  }
  if (scene.fog && !frozen.contains(Cause::Reflectances)) {
    if (const auto* albedo = std::get_if<Spectrum>(&scene.fog->albedo)) filters.push_back(*albedo);
  }
  return filters;
}

std::vector<VisibilityMask> masks_of(const Geometry& geometry,
                                     const std::vector<SurfaceMaterial>& materials,
                                     std::span<const std::uint8_t> ends_light) {
  std::vector<VisibilityMask> masks;
  masks.reserve(geometry.primitive_surface.size());
  for (const std::uint32_t surface : geometry.primitive_surface) {
    const bool lets_pass = materials[geometry.surfaces[surface].material].lets_light_pass();
    masks.push_back(!lets_pass                 ? kOpaqueBit
                    : ends_light[surface] != 0 ? kExactGlassBit
                                               : kTransparentBit);
  }
  return masks;
}

// Which triangles are there from the front only; empty if none is.
std::vector<std::uint8_t> front_only_triangles(const Geometry& geometry,
                                               const std::vector<SurfaceMaterial>& materials) {
  std::vector<std::uint8_t> flags;
  flags.reserve(geometry.triangles.size());
  bool any = false;
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    const Surface& surface = geometry.surfaces[geometry.primitive_surface[i]];
    flags.push_back(materials[surface.material].is_front_only ? 1 : 0);
    any = any || flags.back() != 0;
  }
  return any ? flags : std::vector<std::uint8_t>();
}

// At glass of exact light nothing is shared.
void set_up_places(Geometry& geometry, const std::vector<SurfaceMaterial>& materials) {
  for (std::size_t i = 0; i < geometry.places.size(); ++i) {
    const Surface& surface = geometry.surfaces[geometry.place_surface[i]];
    geometry.places[i].mask =
        materials[surface.material].lets_light_pass() ? kTransparentBit : kOpaqueBit;
    geometry.places[i].front_only = materials[surface.material].is_front_only;
  }
}

std::vector<Box3f> boxes_of_media(const World& world) {
  const Geometry& geometry = world.geometry;
  std::vector<Box3f> boxes(geometry.surfaces.size());
  for (std::size_t i = 0; i < geometry.primitive_surface.size(); ++i) {
    const std::uint32_t surface = geometry.primitive_surface[i];
    const SurfaceMaterial& material = world.materials[geometry.surfaces[surface].material];
    if (material.transmission == Transmission::Medium) boxes[surface].extend(geometry.bounds_of(i));
  }
  std::vector<std::vector<Box3f>> parts(geometry.meshes.size());
  for (std::size_t i = 0; i < geometry.places.size(); ++i) {
    const std::uint32_t surface = geometry.place_surface[i];
    const SurfaceMaterial& material = world.materials[geometry.surfaces[surface].material];
    if (material.transmission != Transmission::Medium) continue;
    const MeshPlace& place = geometry.places[i];
    if (parts[place.mesh].empty()) {
      const TriangleRange& range = geometry.meshes[place.mesh];
      parts[place.mesh] = boxes_of_parts(
          geometry.positions, std::span(geometry.mesh_triangles).subspan(range.first, range.count));
    }
    boxes[surface] = bounds_at(parts[place.mesh], place.linear, place.offset_m);
  }
  std::erase_if(boxes, [](const Box3f& box) { return box.is_empty(); });
  return boxes;
}

// Primitives of bodies and sheets that may be in contact with something. Rays that come from afar
// tell what is first by distances whose rounding grows with the size of the scene.
std::vector<Touching> touching_primitives(const Geometry& geometry,
                                          const std::vector<SurfaceMaterial>& materials,
                                          const Accelerator& accelerator) {
  std::vector<std::uint8_t> matters;
  matters.reserve(geometry.surfaces.size());
  for (const Surface& surface : geometry.surfaces) {
    const SurfaceMaterial& material = materials[surface.material];
    matters.push_back(material.bounds_clear_medium() ||
                      material.transmission == Transmission::ThinSheet);
  }
  const Box3f bounds = accelerator.bounds();
  const Vec3f largest = glm::max(glm::abs(bounds.low), glm::abs(bounds.high));
  const float margin_m = 1e-6f * (largest.x + largest.y + largest.z);
  return find_touching(geometry.shapes({}), geometry.primitive_surface, matters, margin_m);
}

}  // namespace

TabulatedScene tabulate(const Scene& scene, const WorldOptions& options, const Observer& observer,
                        const Spectrum& d65) {
  LaneModel lanes(options, observer, d65, lamp_spectra(scene, d65),
                  filter_spectra(scene, options.frozen));
  Rows rows(lanes.lane_stride());
  Materials materials = tabulate_materials(scene, lanes, rows);
  std::vector<WorldLight> lights = tabulate_lights(scene, lanes, rows);
  std::shared_ptr<const WorldEnvironment> environment = tabulate_environment(scene, lanes, rows);
  const bool shines_all_around =
      environment != nullptr ||
      std::any_of(materials.surfaces.begin(), materials.surfaces.end(),
                  [](const SurfaceMaterial& material) { return material.lights_others; });
  const std::optional<RowId> ambient =
      scene.environment ? std::nullopt : tabulate_ambient(scene, lanes, rows);
  const std::optional<WorldFog> fog = tabulate_fog(scene, lanes, rows);
  const RowId emission_of_d65 = rows.add(lanes.emission(lanes.d65()));
  const RowId inverse_wavelength = rows.add(lanes.inverse_wavelength());
  const RowId uplift_abscissa = rows.add(lanes.uplift_abscissa());
  std::array<RowId, 3> uplift_basis{};
  if (lanes.uplift() == Uplift::MallettYuksel) {
    for (int i = 0; i < 3; ++i) {
      uplift_basis[static_cast<std::size_t>(i)] = rows.add(lanes.uplift_basis(i));
    }
  }
  std::vector<float> xyz_weights = lanes.xyz_weights();
  std::vector<float> luminance_weights = lanes.luminance_weights();
  return {.lanes = std::move(lanes),
          .rows = std::move(rows),
          .xyz_weights = std::move(xyz_weights),
          .luminance_weights = std::move(luminance_weights),
          .materials = std::move(materials.surfaces),
          .textures = std::move(materials.textures),
          .lights = std::move(lights),
          .ambient = ambient,
          .environment = std::move(environment),
          .fog = fog,
          .shines_all_around = shines_all_around,
          .d65 = emission_of_d65,
          .inverse_wavelength = inverse_wavelength,
          .uplift_abscissa = uplift_abscissa,
          .uplift_basis = uplift_basis};
}

World make_world(TabulatedScene tables, Geometry geometry, std::span<const std::uint8_t> ends_light,
                 const std::string& accelerator) {
  const std::vector<VisibilityMask> masks = masks_of(geometry, tables.materials, ends_light);
  for (std::size_t i = 0; i < geometry.surfaces.size(); ++i) {
    geometry.surfaces[i].ends_light = ends_light[i] != 0;
  }
  VisibilityMask bits = 0;
  for (const VisibilityMask mask : masks) bits |= mask;
  set_up_places(geometry, tables.materials);
  for (const MeshPlace& place : geometry.places) bits |= place.mask;
  auto built = build_accelerator(
      accelerator, geometry.shapes(masks, front_only_triangles(geometry, tables.materials)));
  std::vector<Touching> touching = touching_primitives(geometry, tables.materials, *built);
  World world{std::move(tables), std::move(geometry), std::move(built), bits};
  world.touching = std::move(touching);
  world.medium_boxes = boxes_of_media(world);
  for (const Box3f& box : world.medium_boxes) world.media_bounds.extend(box);
  auto emitters = std::make_shared<const WorldEmitters>(world);
  if (!emitters->is_empty()) world.emitters = std::move(emitters);
  return world;
}

std::vector<Spectrum> lamp_spectra(const Scene& scene, const Spectrum& d65) {
  std::vector<Spectrum> lamps;
  bool uses_d65 = false;
  for (const Light& light : scene.lights) {
    if (light.spectrum) {
      lamps.push_back(light.spectrum->spectrum);
    } else {
      uses_d65 = true;  // An RGB colour is a smooth reflectance under D65.
    }
  }
  for (const Material& material : scene.materials) {
    if (material.emission) {
      lamps.push_back(material.emission->spectrum.spectrum);
    } else if (material.emissive_rec709 != Vec3f(0.0f) || material.unlit) {
      uses_d65 = true;
    }
  }
  if (scene.ambient && scene.ambient->luminance_cd_per_m2 > 0.0) {
    lamps.push_back(scene.ambient->spectrum.spectrum);
  }
  if (uses_d65) lamps.push_back(d65);
  return lamps;
}

}  // namespace abbe
