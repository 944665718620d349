/// A scene as it was described: plain indexed data in its source form (RGB stays RGB, a glass stays
/// a formula). What a renderer needs beyond that is made in world/.
///
/// Everywhere here lengths are metres, a `std::uint32_t` that names a thing is its index in the
/// scene's vector of such things, and matrices are of columns, as in glm. Nothing checks itself:
/// validate() (validation.h) says whether indices, sizes and numbers are in their domains.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "abbe/base/shared_values.h"
#include "abbe/color/rgb_space.h"
#include "abbe/math/ray.h"
#include "abbe/math/vec.h"
#include "abbe/optics/dispersion.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// A triple in linear Rec.709 that stands for a colour, still without a spectrum. Channels outside
/// [0, 1] are those of a colour beyond its gamut.
struct RgbRec709 {
  Vec3d rgb_rec709{1.0};
};

/// A reflectance, transmittance or albedo: as RGB (to be uplifted) or measured.
using Reflectance = std::variant<RgbRec709, Spectrum>;

/// A named spectrum with its id, for messages and provenance.
struct NamedSpectrum {
  std::string id;  ///< "illuminant/A"; empty for spectra written in the scene itself.
  Spectrum spectrum;
};

/// What a texture shows outside [0, 1], along one axis of its coordinates.
enum class TextureWrap : std::uint8_t { Repeat, MirroredRepeat, ClampToEdge };
/// How texels become values between them: the nearest, or bilinear with mipmaps.
enum class TextureFilter : std::uint8_t { Nearest, Linear };

/// Decoded pixels, row 0 at the top, always four channels, of as many bits as the file has: codes
/// of 255 or of 65535 are 1.
/// Domain: at least one pixel; exactly one of the two vectors is filled.
struct TextureImage {
  std::string name;
  int width = 0;
  int height = 0;
  SharedValues<std::uint8_t> rgba8;    ///< width·height·4 values, or empty
  SharedValues<std::uint16_t> rgba16;  ///< width·height·4 values, or empty
};

/// An image with the rules of looking it up. What its values mean (sRGB-encoded colour, direction,
/// share) is said by the member of Material that uses it.
struct Texture {
  std::uint32_t image = 0;  ///< Index into images.
  TextureWrap wrap_s = TextureWrap::Repeat;
  TextureWrap wrap_t = TextureWrap::Repeat;
  TextureFilter filter = TextureFilter::Linear;
};

/// A use of a texture: which UV set, and KHR_texture_transform as uv' = linear·uv + offset.
/// Units: texture coordinates; 0, 0 is the upper left corner of the image, 1, 1 the lower right.
struct TextureUse {
  std::uint32_t texture = 0;                               ///< Index into textures.
  std::uint32_t uv_set = 0;                                ///< 0 or 1.
  std::array<float, 4> uv_linear{1.0f, 0.0f, 0.0f, 1.0f};  ///< Row major.
  Vec2f uv_offset{0.0f};
};

/// What alpha does: nothing; all or nothing at Material::alpha_cutoff; the share of light stopped.
enum class AlphaMode : std::uint8_t { Opaque, Mask, Blend };

/// Complex index n + ik of a metal.
/// Units:  dimensionless, over nm.
/// Domain: n > 0, k ≥ 0.
struct Conductor {
  std::string id;  ///< Of the catalogue; empty for an index written in the scene itself.
  Spectrum n, k;
  std::optional<Vec2d> range_nm = {};  ///< Where a table of the catalogue was measured.
};

/// One lossless layer on a surface, seen by its interference colours.
/// Domain: thicknesses ≥ 0, factor in [0, 1].
struct ThinFilm {
  Dispersion index = ConstantIndex{1.3};
  std::string index_id;                      ///< Id of a catalogue material, or empty.
  std::optional<Vec2d> index_range_nm;       ///< Where that material's index is stated.
  float factor = 1.0f;                       ///< Share of the surface that the film covers.
  std::optional<TextureUse> factor_texture;  ///< R.
  /// The thickness; a texture's G mixes it from the minimum, without one it is the maximum.
  float thickness_min_nm = 100.0f, thickness_max_nm = 400.0f;
  std::optional<TextureUse> thickness_texture;
};

/// Whether what a surface emits lights others: as the file's lamps suggest (Scene::emissive_light),
/// always, or never.
enum class LightsOthers : std::uint8_t { Auto, Yes, No };

/// KHR_materials_clearcoat: a clear layer of index 1.5 on top of everything else.
/// Domain: factor, the share of the surface that it covers, and roughness in [0, 1].
struct Clearcoat {
  float factor = 0.0f;
  std::optional<TextureUse> factor_texture;  ///< R.
  float roughness = 0.0f;
  std::optional<TextureUse> roughness_texture;  ///< G.
  std::optional<TextureUse> normal_texture;     ///< Without one it is as smooth as the mesh.
  float normal_scale = 1.0f;
};

/// KHR_materials_sheen: fibres that stand on the surface, under a clearcoat.
/// Domain: colour and roughness in [0, 1].
struct Sheen {
  Vec3f color_rec709{0.0f};
  std::optional<TextureUse> color_texture;  ///< sRGB encoded.
  float roughness = 0.0f;
  std::optional<TextureUse> roughness_texture;  ///< A.
};

/// KHR_materials_anisotropy: microfacets that are rougher along one direction.
/// Units: rotation_rad from the tangent, counter-clockwise. Domain: strength in [0, 1].
struct Anisotropy {
  float strength = 0.0f;
  float rotation_rad = 0.0f;
  std::optional<TextureUse> texture;  ///< RG the direction, B times the strength.
};

/// KHR_materials_specular: what a dielectric reflects, apart from its index.
/// Domain: factor in [0, 1]; colour >= 0, also above 1: the reflectance at normal incidence, which
///         it multiplies, is limited to 1.
struct SpecularPart {
  float factor = 1.0f;
  std::optional<TextureUse> factor_texture;  ///< A.
  Vec3f color_rec709{1.0f};
  std::optional<TextureUse> color_texture;  ///< sRGB encoded.

  /// Whether it says no more than the index does.
  bool is_plain() const {
    return factor == 1.0f && color_rec709 == Vec3f(1.0f) && !factor_texture && !color_texture;
  }
};

/// KHR_materials_diffuse_transmission: light that comes out diffusely on the other side.
/// Domain: factor, its share of what is diffuse, and colour in [0, 1].
struct DiffuseTransmission {
  float factor = 0.0f;
  std::optional<TextureUse> factor_texture;  ///< A.
  Vec3f color_rec709{1.0f};
  std::optional<TextureUse> color_texture;  ///< sRGB encoded.
};

/// Emission given by spectrum and luminance (cd/m²) instead of RGB.
struct SpectralEmission {
  NamedSpectrum spectrum;
  double luminance_cd_per_m2 = 0.0;
};

/// Surfaces below this roughness are treated as perfectly smooth: their lobe is narrower than 0.1°.
inline constexpr float kSmoothRoughness = 0.03f;

/// glTF's metallic-roughness model, the KHR extensions the renderer knows, and ABBE_material.
/// Textures multiply the factor that they stand beside. Defaults are glTF's.
/// Domain: base colour, metallic, roughness and transmission in [0, 1]; what is measured
///         (`reflectance`, `emission`, `conductor`, `absorption_per_m`) goes before RGB.
struct Material {
  std::string name;

  Vec4f base_color_rec709{1.0f};                 ///< Factor, alpha last.
  std::optional<TextureUse> base_color_texture;  ///< sRGB encoded.
  std::optional<NamedSpectrum> reflectance;      ///< Replaces the base colour factor's RGB.
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;  ///< KHR_materials_unlit: the base colour is emitted, nothing else happens.

  float metallic = 1.0f;
  float roughness = 1.0f;
  std::optional<TextureUse> metallic_roughness_texture;  ///< G roughness, B metallic.
  /// A: how glossy it is, where the roughness is 1 less the product of this and 1 − roughness.
  std::optional<TextureUse> glossiness_texture;
  std::optional<TextureUse> normal_texture;
  float normal_scale = 1.0f;

  Vec3f emissive_rec709{0.0f};  ///< cd/m² per channel: emissiveFactor × emissiveStrength.
  std::optional<TextureUse> emissive_texture;
  std::optional<SpectralEmission> emission;  ///< Overrides the emissive factor.
  LightsOthers lights_others = LightsOthers::Auto;

  float transmission = 0.0f;
  std::optional<TextureUse> transmission_texture;  ///< R.
  bool has_volume = false;  ///< A boundary between media; otherwise an infinitely thin sheet.
  Dispersion index = ConstantIndex{1.5};
  bool index_is_infinite = false;       ///< KHR ior 0: Fresnel 1 at all angles.
  std::string index_id;                 ///< Id of a catalogue glass, or empty.
  std::optional<Vec2d> index_range_nm;  ///< Where that glass's index is stated.
  /// Beer–Lambert: transmittance attenuation_color^(x / distance); white for clear glass.
  Vec3d attenuation_color_rec709{1.0};
  double attenuation_distance_m = std::numeric_limits<double>::infinity();
  std::optional<Spectrum> absorption_per_m;  ///< Replaces the attenuation above.

  std::optional<Conductor> conductor;
  std::optional<ThinFilm> film;
  std::optional<Clearcoat> clearcoat;
  std::optional<Sheen> sheen;
  std::optional<Anisotropy> anisotropy;
  std::optional<SpecularPart> specular;
  std::optional<DiffuseTransmission> diffuse_transmission;
  std::optional<double> ambient_factor;  ///< k_a; default: diffuse albedo × (1 − F).
  /// Of closed bodies that overlap, the one of the highest owns the space.
  std::int16_t priority = 0;

  /// Whether its triangles are there from the front only, for every kind of ray: where it is not
  /// double sided, unless light goes through it.
  /// Source: glTF 2.0, 3.9.6; KHR_materials_volume has no back faces to cull.
  bool is_front_only() const {
    return !double_sided && transmission == 0.0f && !has_volume && !diffuse_transmission;
  }
};

/// Triangles with their attributes; per-vertex vectors are empty or as long as positions.
/// Shape:  three indices into positions a triangle, counterclockwise seen from the front.
/// Units:  metres in mesh space; normals and the first three of tangents of unit length.
struct Mesh {
  std::string name;
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<Vec4f> tangents;  ///< w is the sign of the bitangent.
  std::vector<Vec2f> uv[2];
  std::vector<Vec4f> colors_rec709;  ///< COLOR_0, multiplies the base colour.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t material = 0;
  /// What of its file may move its vertices; where they stand, they have been moved already.
  std::uint32_t morph_targets = 0, joints = 0;
};

/// A ball about the origin of its node's space.
/// Domain: radius_m > 0.
struct SphereShape {
  double radius_m = 1.0;
};
/// A convex polyhedron: what all of its planes have behind them, in its node's space.
/// Domain: planes that enclose a body of finite size (convex.h).
struct ConvexShape {
  std::vector<Vec4d> planes;  ///< n·x ≤ d as (nx, ny, nz, d); n need not be of unit length.
};
/// An exact shape of ABBE_shape: a closed body that no triangles approximate. Its outside is the
/// front; it has no texture coordinates.
struct Shape {
  std::string name;
  std::variant<SphereShape, ConvexShape> geometry;
  std::uint32_t material = 0;
};

/// A mesh or an exact shape, placed. `to_world` is affine.
struct Instance {
  std::string name;
  std::variant<std::uint32_t, Shape> what;  ///< Index into meshes, or a shape.
  Mat4d to_world{1.0};
};

/// How a lamp without an area sends its light: into all directions from a place, into a cone from a
/// place, or along one direction everywhere (within Light::beam, if there is one).
enum class LightType : std::uint8_t { Point, Spot, Directional };

/// Limits a directional light to a rectangle about the origin of its XY plane.
struct BeamSize {
  double width_m = 1.0;   ///< Along X.
  double height_m = 1.0;  ///< Along Y.
};

/// A flat lamp about the origin of its node's XY plane that shines evenly, by Lambert's law, to −Z.
struct RectangleLamp {
  double width_m = 1.0;   ///< Along X.
  double height_m = 1.0;  ///< Along Y.
};
/// The same, round.
struct DiskLamp {
  double radius_m = 0.5;
};
/// A ball about the node's origin that shines evenly all around.
struct SphereLamp {
  double radius_m = 0.5;
};
/// A disc on the sky of even radiance, as the sun is.
struct SkyDisc {
  double angle_deg = 0.53;  ///< Its diameter.
};
/// The extent of a lamp; its light is softly shadowed. The lamp itself is not seen.
/// Domain: lengths > 0; 0 < angle_deg ≤ 180. A SkyDisc belongs to directional lights, the others to
///         point and spot lamps.
using LampShape = std::variant<RectangleLamp, DiskLamp, SphereLamp, SkyDisc>;

/// KHR_lights_punctual, placed. Shines along −Z of `to_world` (rotation and translation only).
/// Domain: intensity ≥ 0, range_m > 0, 0 ≤ inner_cone_rad < outer_cone_rad (of spots).
struct Light {
  std::string name;
  LightType type = LightType::Point;
  Vec3d color_rec709{1.0};
  std::optional<NamedSpectrum> spectrum;  ///< Replaces the colour; scaled to the intensity.
  double intensity = 1.0;                 ///< Candela for point and spot, lux for directional.
  double range_m = std::numeric_limits<double>::infinity();
  double inner_cone_rad = 0.0;
  double outer_cone_rad = 0.78539816339744831;
  std::optional<BeamSize> beam;  ///< Directional lights only, and not with a shape.
  std::optional<LampShape> shape;
  Mat4d to_world{1.0};
};

/// All rays from one point. The angle is that of the image's height; the width follows its shape.
/// Domain: 0 < yfov_rad < π.
struct PerspectiveCamera {
  double yfov_rad = 0.8;
};
/// Parallel rays; both extents are used as given, whatever the image's shape.
struct OrthographicCamera {
  double xmag = 1.0;  ///< Half width, metres.
  double ymag = 1.0;  ///< Half height, metres.
};

/// A camera, placed. Looks along −Z of `to_world` with +Y up; its scale means nothing.
struct Camera {
  std::string name;
  std::variant<PerspectiveCamera, OrthographicCamera> projection;
  double aspect_ratio = 16.0 / 9.0;  ///< Only proposes the image's default shape.
  Mat4d to_world{1.0};
};

/// ABBE_scene.ambient: L_a of the illumination equation, the same from all around.
/// Domain: luminance_cd_per_m2 ≥ 0.
struct Ambient {
  double luminance_cd_per_m2 = 0.0;
  NamedSpectrum spectrum;
};

/// Light from all around as an image of the sky, each texel as wide in angle as every other: row 0
/// at the zenith (+Y); the middle of the image towards +X, a quarter from the left towards −Z, as
/// Blender, three.js and the glTF sample viewer have it.
/// Shape:  width·height texels; `rgb_rec709` or, of a spectral image, `bands`, band_nm.size() of
/// them
///         a texel; the other is empty.
/// Units:  rgb_rec709: cd/m² per channel, may be negative; bands: W·m⁻²·sr⁻¹·nm⁻¹ at
///         ascending wavelengths, ≥ 0, linear between them and 0 beyond.
struct EnvironmentImage {
  int width = 0;
  int height = 0;
  std::vector<Vec3f> rgb_rec709;
  std::vector<float> band_nm;
  std::vector<float> bands;
};

/// ABBE_scene.environment. It takes the place of ambient light.
/// Domain: scale ≥ 0.
struct Environment {
  std::string name;  ///< Of its file, or of the rig that it belongs to.
  EnvironmentImage image;
  double scale = 1.0;
  double rotation_deg = 0.0;  ///< About +Y, counterclockwise seen from above.
  bool visible = true;        ///< Whether camera rays that meet nothing see it.
  /// The light that RGB colours are those of; absent: D65. Scaled to 1 cd/m² for white.
  std::optional<NamedSpectrum> spectrum;
};

/// ABBE_scene.fog: a homogeneous medium outside all bodies that scatters evenly, once.
/// Domain: extinction_per_m ≥ 0, albedo in [0, 1].
struct Fog {
  double extinction_per_m = 0.0;
  Reflectance albedo;  ///< Share of what it takes from light that it scatters.
};

/// An animation of the file, as a choice: a scene is at rest, or posed where it was loaded.
struct Animation {
  std::string name;
  double length_s = 0.0;  ///< From time 0 to its last key.
};

/// All that a file says of one scene. Made by load/ or by hand; immutable while it is rendered.
/// Domain: validate() (validation.h) passes; a renderer relies on it and checks nothing again. A
///         scene without cameras is rendered after add_default_camera(), one without light may get
///         a rig (rigs.h).
struct Scene {
  std::string name;
  std::string generator;  ///< The program that wrote the file; empty: it does not say.
  RgbSpace color_space = RgbSpace::Rec709;  ///< Of colour textures; all else is linear Rec.709.
  std::vector<TextureImage> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::optional<Ambient> ambient;
  std::shared_ptr<const Environment> environment;  ///< Null: none.
  std::optional<Fog> fog;
  std::vector<Animation> animations;
  std::vector<std::string> variants;  ///< Names of the file's sets of materials, as a choice.
  bool uses_abbe =
      false;  ///< Whether its file has an extension of ours: it can say what lights it.
  /// Whether surfaces that emit light others where their material leaves it open.
  bool emissive_light = false;
  std::optional<double> exposure_ev;  ///< Of display images; absent: what they show decides.
  /// A place p of the scene as it was described is p − origin_m here (local_origin.h).
  Vec3d origin_m{0.0};
  std::string content_hash;  ///< Hash of the files the scene was made of, 16 hex digits.
};

/// An axis-aligned box; empty when any low exceeds its high.
struct Box3d {
  Vec3d low{std::numeric_limits<double>::infinity()};
  Vec3d high{-std::numeric_limits<double>::infinity()};

  void extend(const Box3d& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  bool is_empty() const { return glm::any(glm::greaterThan(low, high)); }
  Vec3d center() const { return 0.5 * low + 0.5 * high; }
};

/// World bounds of all instances, or of one; exact for meshes, conservative for shapes.
/// Units:  metres. Empty without instances.
Box3d bounds_of(const Scene& scene);
Box3d bounds_of(const Scene& scene, const Instance& instance);

/// A camera that frames the bounds from the front, a little from above and from the right, so that
/// a box shows three of its faces; of the name "default".
Camera framing_camera(const Scene& scene);

/// Adds it to a scene that has none. Returns whether it did.
bool add_default_camera(Scene& scene);

}  // namespace abbe
