#include "abbe/scene/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/scene/convex.h"
#include "abbe/scene/texture_uses.h"

namespace abbe {
namespace {

bool is_unit(double x) {
  return x >= 0.0 && x <= 1.0;
}
bool is_positive(double x) {
  return x > 0.0 && std::isfinite(x);
}
bool is_amount(double x) {
  return x >= 0.0 && std::isfinite(x);
}

bool are_unit(const Vec3f& v) {
  return is_unit(v.x) && is_unit(v.y) && is_unit(v.z);
}

template <typename V>
bool is_finite(const V& v) {
  for (int i = 0; i < V::length(); ++i) {
    if (!std::isfinite(v[i])) return false;
  }
  return true;
}

bool is_finite(const Mat4d& m) {
  return is_finite(m[0]) && is_finite(m[1]) && is_finite(m[2]) && is_finite(m[3]);
}

template <typename V>
bool are_finite(const std::vector<V>& values) {
  return std::all_of(values.begin(), values.end(), [](const V& v) { return is_finite(v); });
}

bool are_amounts(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float x) { return is_amount(x); });
}

// Whether it keeps volumes: no axis is 0, no two are one.
bool is_invertible(const Mat4d& m) {
  const Mat3d linear(m);
  const double volume = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return std::abs(glm::determinant(linear)) > 1e-12 * volume;
}

class Validator {
 public:
  Validator(const Scene& scene, const std::string& where) : scene_(scene), where_(where) {}

  void run() {
    check_all(scene_.images, "images", [this](const TextureImage& i) { check(i); });
    check_all(scene_.textures, "textures", [this](const Texture& t) {
      require(t.image < scene_.images.size(), "an image out of range", "an index into images");
    });
    check_all(scene_.materials, "materials", [this](const Material& m) { check(m); });
    check_all(scene_.meshes, "meshes", [this](const Mesh& m) { check(m); });
    check_all(scene_.instances, "instances", [this](const Instance& i) { check(i); });
    check_all(scene_.lights, "lights", [this](const Light& l) { check(l); });
    check_all(scene_.cameras, "cameras", [this](const Camera& c) { check(c); });
    if (scene_.fog) {
      element_ = "fog";
      require(is_amount(scene_.fog->extinction_per_m), "its extinction", "at least 0");
    }
    if (scene_.ambient) {
      element_ = "ambient";
      require(is_amount(scene_.ambient->luminance_cd_per_m2), "its luminance", "at least 0");
    }
    if (scene_.environment) {
      element_ = "environment";
      check(*scene_.environment);
    }
  }

 private:
  template <typename T, typename Check>
  void check_all(const std::vector<T>& elements, const char* name, const Check& check_one) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      element_ = name;
      index_ = i;
      check_one(elements[i]);
    }
  }

  void require(bool good, const char* found, const char* expected) const {
    if (good) return;
    throw_input_error(fmt::format("{}: {}[{}]", where_, element_, index_), found, expected);
  }

  void check(const TextureImage& image) const {
    require(image.width > 0 && image.height > 0, "an empty image", "at least one pixel");
    const std::size_t values = std::size_t{4} * static_cast<std::size_t>(image.width) *
                               static_cast<std::size_t>(image.height);
    require(image.rgba8.size() == values ? image.rgba16.empty()
                                         : image.rgba8.empty() && image.rgba16.size() == values,
            "pixels of another number", "width x height x 4 values of one type");
  }

  void check(const Material& m) const {
    const ThinFilm film = m.film.value_or(ThinFilm{});
    const Clearcoat coat = m.clearcoat.value_or(Clearcoat{});
    const Sheen sheen = m.sheen.value_or(Sheen{});
    const Anisotropy anisotropy = m.anisotropy.value_or(Anisotropy{});
    const SpecularPart specular = m.specular.value_or(SpecularPart{});
    const DiffuseTransmission through = m.diffuse_transmission.value_or(DiffuseTransmission{});
    require(is_unit(coat.factor) && is_unit(coat.roughness) && std::isfinite(coat.normal_scale),
            "a clearcoat", "factor and roughness in [0, 1]");
    require(are_unit(sheen.color_rec709) && is_unit(sheen.roughness), "a sheen",
            "colour and roughness in [0, 1]");
    require(is_unit(anisotropy.strength) && std::isfinite(anisotropy.rotation_rad), "an anisotropy",
            "a strength in [0, 1]");
    require(is_unit(specular.factor) && is_amount(specular.color_rec709.x) &&
                is_amount(specular.color_rec709.y) && is_amount(specular.color_rec709.z),
            "a specular part", "a factor in [0, 1], a colour of at least 0");
    require(is_unit(through.factor) && are_unit(through.color_rec709), "a diffuse transmission",
            "factor and colour in [0, 1]");
    for (const TextureUse* use : texture_uses(m)) {
      require(use->texture < scene_.textures.size(), "a texture out of range",
              "an index into textures");
      require(use->uv_set < 2, "a third UV set", "0 or 1");
      require(is_finite(use->uv_offset) && std::all_of(use->uv_linear.begin(), use->uv_linear.end(),
                                                       [](float x) { return std::isfinite(x); }),
              "a texture transform that is not finite", "a finite one");
    }
    for (int c = 0; c < 4; ++c) {
      // Colours of wider gamuts have channels below 0 and above 1.
      require(std::isfinite(m.base_color_rec709[c]), "a base colour that is not finite", "numbers");
    }
    require(is_unit(m.metallic), "metallic outside its range", "0 to 1");
    require(is_unit(m.roughness), "roughness outside its range", "0 to 1");
    require(is_unit(m.transmission), "transmission outside its range", "0 to 1");
    require(m.alpha_cutoff >= 0.0f, "an alpha cutoff below 0", "at least 0");
    for (int c = 0; c < 3; ++c) {
      require(is_amount(m.emissive_rec709[c]), "an emission below 0 or not finite", "at least 0");
      require(std::isfinite(m.attenuation_color_rec709[c]),
              "an attenuation colour that is not finite", "numbers");
    }
    require(m.attenuation_distance_m > 0.0, "an attenuation distance of 0 or less", "above 0");
    if (m.emission) {
      require(is_amount(m.emission->luminance_cd_per_m2), "a luminance below 0", "at least 0");
    }
    if (const auto* constant = std::get_if<ConstantIndex>(&m.index)) {
      require(constant->n >= 1.0 && std::isfinite(constant->n), "an index below 1", "at least 1");
    }
    if (const auto* abbe = std::get_if<AbbeNumber>(&m.index)) {
      require(abbe->n_d >= 1.0 && std::isfinite(abbe->n_d) && abbe->V_d > 0.0,
              "an index below 1 or an Abbe number of 0", "n_d of at least 1 and V_d above 0");
    }
    require(is_unit(film.factor), "a film's factor outside its range", "0 to 1");
    require(is_amount(film.thickness_min_nm) && is_amount(film.thickness_max_nm),
            "a film's thickness below 0 or not finite", "at least 0");
    if (m.ambient_factor) require(is_unit(*m.ambient_factor), "an ambient factor", "0 to 1");
  }

  void check(const Mesh& m) const {
    const std::size_t n = m.positions.size();
    const auto fits = [n](const auto& attribute) {
      return attribute.empty() || attribute.size() == n;
    };
    require(fits(m.normals) && fits(m.tangents) && fits(m.uv[0]) && fits(m.uv[1]) &&
                fits(m.colors_rec709),
            "attributes of another length", "as many as positions, or none");
    require(m.material < scene_.materials.size(), "a material out of range",
            "an index into materials");
    for (const auto& triangle : m.triangles) {
      require(triangle[0] < n && triangle[1] < n && triangle[2] < n, "a vertex out of range",
              "an index into positions");
    }
    require(are_finite(m.positions), "a vertex that is not finite", "finite vertices");
    require(are_finite(m.normals) && are_finite(m.tangents) && are_finite(m.uv[0]) &&
                are_finite(m.uv[1]) && are_finite(m.colors_rec709),
            "an attribute that is not finite", "finite attributes");
  }

  void check(const Instance& instance) const {
    require(is_finite(instance.to_world), "a transform that is not finite", "a finite one");
    require(is_invertible(instance.to_world), "a transform that flattens it", "one with a volume");
    if (const auto* mesh = std::get_if<std::uint32_t>(&instance.what)) {
      require(*mesh < scene_.meshes.size(), "a mesh out of range", "an index into meshes");
      return;
    }
    const Shape& shape = std::get<Shape>(instance.what);
    require(shape.material < scene_.materials.size(), "a material out of range",
            "an index into materials");
    if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) {
      require(is_positive(sphere->radius_m), "a radius of 0 or less", "above 0");
      return;
    }
    const auto& body = std::get<ConvexShape>(shape.geometry);
    require(are_finite(body.planes) && is_bounded(body), "planes that leave the body open",
            "finite planes all around it");
  }

  void check(const Light& light) const {
    for (int c = 0; c < 3; ++c) {
      require(is_amount(light.color_rec709[c]), "a colour below 0", "at least 0");
    }
    require(is_amount(light.intensity), "an intensity below 0", "at least 0");
    require(light.range_m > 0.0, "a range of 0 or less", "above 0");
    require(light.inner_cone_rad >= 0.0 && light.inner_cone_rad < light.outer_cone_rad,
            "cones in the wrong order", "inner below outer");
    require(is_finite(light.to_world), "a transform that is not finite", "a finite one");
    if (!light.shape) return;
    const bool is_directional = light.type == LightType::Directional;
    require(!light.beam, "a beam with a shape", "one of them");
    require(std::holds_alternative<SkyDisc>(*light.shape) == is_directional,
            "a shape of another kind of light",
            "a disc on the sky of directional lights, else a rectangle, disk or sphere");
    if (const auto* rectangle = std::get_if<RectangleLamp>(&*light.shape)) {
      require(is_positive(rectangle->width_m) && is_positive(rectangle->height_m),
              "a side of 0 or less", "above 0");
    } else if (const auto* disk = std::get_if<DiskLamp>(&*light.shape)) {
      require(is_positive(disk->radius_m), "a radius of 0 or less", "above 0");
    } else if (const auto* sphere = std::get_if<SphereLamp>(&*light.shape)) {
      require(is_positive(sphere->radius_m), "a radius of 0 or less", "above 0");
    } else {
      const double angle_deg = std::get<SkyDisc>(*light.shape).angle_deg;
      require(angle_deg > 0.0 && angle_deg <= 180.0, "a disc's angle", "above 0, at most 180");
    }
  }

  void check(const Environment& environment) const {
    const EnvironmentImage& image = environment.image;
    require(image.width > 0 && image.height > 0, "an empty image", "at least one pixel");
    const std::size_t texels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    require(image.band_nm.empty()
                ? image.rgb_rec709.size() == texels && image.bands.empty()
                : image.rgb_rec709.empty() && image.bands.size() == texels * image.band_nm.size(),
            "texels of another number", "width x height colours or spectra");
    require(are_finite(image.rgb_rec709) && are_amounts(image.bands),
            "radiance that is not finite, or in a band below 0", "finite radiance");
    require(std::is_sorted(image.band_nm.begin(), image.band_nm.end(), std::less_equal<>()),
            "bands out of order", "ascending wavelengths");
    require(is_amount(environment.scale), "a scale below 0 or not finite", "at least 0");
    require(std::isfinite(environment.rotation_deg), "a rotation that is not finite", "degrees");
  }

  void check(const Camera& camera) const {
    if (const auto* perspective = std::get_if<PerspectiveCamera>(&camera.projection)) {
      require(perspective->yfov_rad > 0.0 && perspective->yfov_rad < kPi, "a field of view",
              "above 0 and below pi");
    } else {
      const auto& orthographic = std::get<OrthographicCamera>(camera.projection);
      require(is_positive(orthographic.xmag) && is_positive(orthographic.ymag),
              "a half width or height of 0 or less", "above 0");
    }
    require(is_positive(camera.aspect_ratio), "an aspect ratio of 0 or less", "above 0");
    require(is_finite(camera.to_world) && is_invertible(camera.to_world),
            "a transform that is not finite or flattens", "a finite one with a volume");
  }

  const Scene& scene_;
  const std::string& where_;
  const char* element_ = "";
  std::size_t index_ = 0;
};

}  // namespace

void validate(const Scene& scene, const std::string& where) {
  Validator(scene, where).run();
}

void validate(const Camera& camera, const std::string& where) {
  Scene scene;
  scene.cameras = {camera};
  validate(scene, where);
}

}  // namespace abbe
