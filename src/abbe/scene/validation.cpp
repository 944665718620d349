#include "abbe/scene/validation.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"

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

bool is_finite(const Mat4d& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
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
    require(image.rgba8.size() == values ? image.rgba_float.empty()
                                         : image.rgba8.empty() && image.rgba_float.size() == values,
            "pixels of another number", "width x height x 4 values of one type");
  }

  void check(const Material& m) const {
    const ThinFilm film = m.film.value_or(ThinFilm{});
    for (const auto* use : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                            &m.emissive_texture, &m.transmission_texture, &film.factor_texture,
                            &film.thickness_texture}) {
      if (!*use) continue;
      require((*use)->texture < scene_.textures.size(), "a texture out of range",
              "an index into textures");
      require((*use)->uv_set < 2, "a third UV set", "0 or 1");
    }
    for (int c = 0; c < 4; ++c) {
      require(is_unit(m.base_color_rec709[c]), "a base colour outside its range", "0 to 1");
    }
    require(is_unit(m.metallic), "metallic outside its range", "0 to 1");
    require(is_unit(m.roughness), "roughness outside its range", "0 to 1");
    require(is_unit(m.transmission), "transmission outside its range", "0 to 1");
    require(m.alpha_cutoff >= 0.0f, "an alpha cutoff below 0", "at least 0");
    for (int c = 0; c < 3; ++c) {
      require(is_amount(m.emissive_rec709[c]), "an emission below 0 or not finite", "at least 0");
      require(is_unit(m.attenuation_color_rec709[c]), "an attenuation colour outside its range",
              "0 to 1");
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
    for (const Vec3f& p : m.positions) {
      require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z),
              "a vertex that is not finite", "finite vertices");
    }
  }

  void check(const Instance& instance) const {
    require(is_finite(instance.to_world), "a transform that is not finite", "a finite one");
    if (const auto* mesh = std::get_if<std::uint32_t>(&instance.what)) {
      require(*mesh < scene_.meshes.size(), "a mesh out of range", "an index into meshes");
      return;
    }
    const Shape& shape = std::get<Shape>(instance.what);
    require(shape.material < scene_.materials.size(), "a material out of range",
            "an index into materials");
    if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) {
      require(is_positive(sphere->radius_m), "a radius of 0 or less", "above 0");
    }
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
    require(is_finite(camera.to_world), "a transform that is not finite", "a finite one");
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

}  // namespace abbe
