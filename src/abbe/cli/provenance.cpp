#include "abbe/cli/provenance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "abbe/base/isa.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {
namespace {

// The spectra of everything that shines: ids of the catalogue, "scene" for the scene's own. Colours
// of lights and emission stand for D65.
std::string illuminant_text(const Scene& scene) {
  std::set<std::string> names;
  const auto add = [&names](const NamedSpectrum& spectrum) {
    names.insert(spectrum.id.empty() ? "scene" : spectrum.id);
  };
  constexpr const char* kOfColours = "illuminant/D65";
  for (const Light& light : scene.lights) {
    light.spectrum ? add(*light.spectrum) : void(names.insert(kOfColours));
  }
  for (const Material& material : scene.materials) {
    if (material.emission) {
      add(material.emission->spectrum);
    } else if (material.emissive_rec709 != Vec3f(0.0f) || material.unlit) {
      names.insert(kOfColours);
    }
  }
  if (scene.ambient && scene.ambient->luminance_cd_per_m2 > 0.0) add(scene.ambient->spectrum);
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_wavelengths(const RenderSettings& settings, std::map<std::string, Attribute>& out) {
  if (settings.mode != Mode::Spectral) return;
  const WavelengthOptions& wavelengths = settings.wavelengths;
  if (!wavelengths.exact_nm.empty()) {
    out["abbe:lines"] = fmt::format("{} nm", fmt::join(wavelengths.exact_nm, ","));
    return;
  }
  out["abbe:wavelengths"] = wavelengths.count;
  out["abbe:range"] = fmt::format("{}:{} nm", wavelengths.range_min_nm, wavelengths.range_max_nm);
  if (settings.bands) {
    out["abbe:bands"] = fmt::format("{}:{}:{} nm", settings.bands->begin_nm, settings.bands->end_nm,
                                    settings.bands->step_nm);
  }
}

}  // namespace

std::map<std::string, Attribute> provenance(const PreparedScene& prepared,
                                            const RenderSettings& settings,
                                            const std::string& color_space, bool is_complete) {
  std::map<std::string, Attribute> out;
  out["abbe:version"] = std::string(ABBE_VERSION);
  out["abbe:isa"] = isa_level();
  out["abbe:complete"] = is_complete ? 1 : 0;
  out["abbe:mode"] = mode_name(settings.mode);

  out["abbe:illuminant"] = illuminant_text(prepared.scene);
  const bool uplifts =
      settings.mode == Mode::Spectral && !settings.frozen.contains(Cause::Reflectances);
  out["abbe:uplift"] = uplifts ? fmt::format("{}, {}", uplift_title(settings.uplift),
                                             primaries_of(prepared.scene.color_space).title)
                               : std::string("none");
  out["abbe:primaries"] = color_space;
  out["abbe:unit"] = std::string("D65 at 1 cd/m2 is 1, 1, 1");

  out["abbe:sceneHash"] = prepared.scene.content_hash;
  if (!prepared.scene.name.empty()) out["abbe:scene"] = prepared.scene.name;
  out["abbe:camera"] = prepared.has_default_camera             ? std::string("default")
                       : prepared.chosen_camera().name.empty() ? fmt::format("{}", prepared.camera)
                                                               : prepared.chosen_camera().name;
  if (prepared.has_default_lights) out["abbe:lights"] = std::string("default");

  if (!prepared.lamp_id.empty()) out["abbe:lamp"] = prepared.lamp_id;

  add_wavelengths(settings, out);
  out["abbe:samples"] = settings.samples_per_pixel;
  out["abbe:filter"] = settings.filter;
  out["abbe:depth"] = settings.max_depth;
  out["abbe:cutoff"] = settings.cutoff;
  out["abbe:caustics"] = std::string(settings.caustics ? "exact" : "off");
  out["abbe:chain"] = settings.inner_reflections;
  out["abbe:drop"] = settings.drop ? 1 : 0;
  out["abbe:seed"] = fmt::format("{}", settings.seed);
  if (!settings.frozen.empty()) out["abbe:freeze"] = causes_text(settings.frozen);
  if (!settings.aovs.empty()) out["abbe:aov"] = fmt::format("{}", fmt::join(settings.aovs, ","));

  if (settings.bands || !settings.wavelengths.exact_nm.empty()) {
    // The layout of Fichet, Pacanowski & Wilkie, JCGT 10(3), 2021.
    out["spectralLayoutVersion"] = std::string("1.0");
    out["emissiveUnits"] = std::string("W.m^-2.sr^-1");
    out["EV"] = 0.0f;
  }
  return out;
}

std::vector<IdNames> id_names(const Scene& scene, const Image& image) {
  std::vector<IdNames> result;
  const auto add = [&](const char* channel, const auto& named, const char* kind) {
    if (!image.channel_index(channel)) return;
    IdNames ids{channel, {}};
    // 0 is what no ray met.
    std::uint32_t id = 0;
    for (const auto& one : named) {
      ++id;
      ids.names[id] = one.name.empty() ? fmt::format("{} {}", kind, id - 1) : one.name;
    }
    result.push_back(std::move(ids));
  };
  add("objectId", scene.instances, "object");
  add("materialId", scene.materials, "material");
  return result;
}

}  // namespace abbe
