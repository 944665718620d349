#include "abbe/session/provenance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <variant>

#include "abbe/base/error.h"
#include "abbe/base/isa.h"
#include "abbe/base/text.h"
#include "abbe/session/spectra_hash.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {
namespace {

constexpr const char* kUnit = " nm";

// The spectra of everything that shines: ids of the catalogue, "scene" for the scene's own. Colours
// of lights and emission stand for D65.
std::string illuminant_text(const Scene& scene) {
  std::set<std::string> names;
  const auto add = [&names](const NamedSpectrum& spectrum) {
    names.insert(spectrum.id.empty() ? "scene" : spectrum.id);
  };
  constexpr const char* kOfColors = "illuminant/D65";
  for (const Light& light : scene.lights) {
    light.spectrum ? add(*light.spectrum) : void(names.insert(kOfColors));
  }
  for (const Material& material : scene.materials) {
    if (material.emission) {
      add(material.emission->spectrum);
    } else if (material.emissive_rec709 != Vec3f(0.0f) || material.unlit) {
      names.insert(kOfColors);
    }
  }
  if (scene.environment && !scene.environment->image.band_nm.empty()) {
    names.insert("scene");
  } else if (scene.environment) {
    scene.environment->spectrum ? add(*scene.environment->spectrum) : void(names.insert(kOfColors));
  } else if (scene.ambient && scene.ambient->luminance_cd_per_m2 > 0.0) {
    add(scene.ambient->spectrum);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_wavelengths(const RenderSettings& settings, std::map<std::string, Attribute>& out) {
  if (settings.mode != Mode::Spectral) return;
  const WavelengthOptions& wavelengths = settings.wavelengths;
  if (!wavelengths.exact_nm.empty()) {
    out["abbe:lines"] = lines_text(wavelengths) + kUnit;
    return;
  }
  out["abbe:wavelengths"] = wavelengths.count;
  out["abbe:range"] = range_text(wavelengths) + kUnit;
  if (settings.bands) out["abbe:bands"] = bands_text(*settings.bands) + kUnit;
}

std::string before(const std::string& text, const std::string& end) {
  return text.substr(0, text.find(end));
}

/// The attributes of a file, read as settings; what is missing leaves a setting as it is.
class Reader {
 public:
  explicit Reader(const std::map<std::string, Attribute>& attributes) : attributes_(attributes) {}

  /// Empty when there is none.
  std::string text(const std::string& name, const std::string& end = "") const {
    const auto found = attributes_.find("abbe:" + name);
    if (found == attributes_.end()) return {};
    const auto* value = std::get_if<std::string>(&found->second);
    if (value == nullptr) reject(name, "no text");
    return end.empty() ? *value : before(*value, end);
  }
  template <typename T>
  void get(const std::string& name, T& setting) const {
    const auto found = attributes_.find("abbe:" + name);
    if (found == attributes_.end()) return;
    const auto* value = std::get_if<T>(&found->second);
    if (value == nullptr) reject(name, "a value of another type");
    setting = *value;
  }
  std::vector<double> numbers(const std::string& name, char separator) const {
    std::vector<double> numbers;
    const std::string list = text(name, kUnit);
    if (list.empty()) return numbers;
    for (const std::string& part : split(list, separator)) {
      const auto number = number_of(part);
      if (!number) reject(name, in_quotes(list));
      numbers.push_back(*number);
    }
    return numbers;
  }
  std::vector<std::string> names(const std::string& name) const {
    const std::string list = text(name);
    return list.empty() ? std::vector<std::string>{} : split(list, ',');
  }
  /// The setting that a word stands for; of a missing one, as it is.
  template <typename T>
  void get_word(const std::string& name, const std::string& word,
                const std::map<std::string, T>& meanings, T& setting) const {
    if (!attributes_.contains("abbe:" + name)) return;
    const auto meaning = meanings.find(word);
    if (meaning == meanings.end()) reject(name, in_quotes(word));
    setting = meaning->second;
  }
  [[noreturn]] static void reject(const std::string& name, const std::string& found) {
    throw_input_error("abbe:" + name, found, "what this version writes");
  }

 private:
  const std::map<std::string, Attribute>& attributes_;
};

RenderSettings settings_of(const Reader& read) {
  RenderSettings settings;
  settings.mode = mode_from_name(read.text("mode"));
  read.get("samples", settings.samples_per_pixel);
  read.get("noise", settings.noise);
  read.get("noiseExposure", settings.noise_exposure_ev);
  read.get("wavelengths", settings.wavelengths.count);
  if (const std::vector<double> range_nm = read.numbers("range", ':'); !range_nm.empty()) {
    if (range_nm.size() != 2) Reader::reject("range", "no two ends");
    settings.wavelengths.range_min_nm = range_nm[0];
    settings.wavelengths.range_max_nm = range_nm[1];
  }
  settings.wavelengths.exact_nm = read.numbers("lines", ',');
  if (const std::string bands = read.text("bands", kUnit); !bands.empty()) {
    settings.bands = parse_bands(bands);
  }
  if (const std::string filter = read.text("filter"); !filter.empty()) settings.filter = filter;
  read.get("depth", settings.max_depth);
  read.get("cutoff", settings.cutoff);
  read.get_word("caustics", read.text("caustics"), {{"exact", true}, {"off", false}},
                settings.caustics);
  read.get("chain", settings.inner_reflections);
  const auto is_on = [&read](const char* name) {
    int value = 0;
    read.get(name, value);
    if (value != 0 && value != 1) Reader::reject(name, std::to_string(value));
    return value == 1;
  };
  settings.drop = is_on("drop");
  settings.multiple_scattering = is_on("multipleScattering");
  if (const std::string text = read.text("seed"); !text.empty()) {
    const auto seed = whole_u32_of(text);
    if (!seed) Reader::reject("seed", in_quotes(text));
    settings.seed = *seed;
  }
  std::map<std::string, Uplift> uplifts{{"none", settings.uplift}};
  for (const Uplift uplift : {Uplift::JakobHanika, Uplift::MallettYuksel}) {
    uplifts[uplift_title(uplift)] = uplift;
  }
  read.get_word("uplift", read.text("uplift", ","), uplifts, settings.uplift);
  if (const auto causes = read.names("freeze"); !causes.empty()) {
    settings.frozen = parse_causes(causes);
  }
  settings.aovs = read.names("aov");
  return settings;
}

// The window of a file and how it keeps its pixels.
void read_form(const ExrHeader& header, Recipe& recipe) {
  const Vec2i size(header.width, header.height), from = header.data_origin;
  recipe.settings.size = size;
  if (header.full_size != Vec2i(0)) {
    recipe.settings.size = header.full_size;
    recipe.settings.crop = PixelRect{from.x, from.y, from.x + size.x, from.y + size.y};
  }
  recipe.form.compression = header.compression;
  recipe.form.tile_size = header.tile_size;
  recipe.form.multi_part = header.has_named_parts;
  recipe.form.half =
      std::any_of(header.channels.begin(), header.channels.end(),
                  [](const ExrHeader::Channel& channel) { return channel.type == "half"; });
}

}  // namespace

std::string range_text(const WavelengthOptions& wavelengths) {
  return fmt::format("{}:{}", wavelengths.range_min_nm, wavelengths.range_max_nm);
}

std::string lines_text(const WavelengthOptions& wavelengths) {
  return fmt::format("{}", fmt::join(wavelengths.exact_nm, ","));
}

std::optional<Recipe> recipe_of(const ExrHeader& header) {
  const auto& attributes = header.attributes;
  if (!attributes.contains("abbe:version") || !attributes.contains("abbe:mode") ||
      attributes.contains("abbe:developed")) {
    return std::nullopt;
  }
  const Reader read(attributes);
  Recipe recipe;
  try {
    recipe.settings = settings_of(read);
    read_form(header, recipe);
    recipe.scene.scene = read.text("scene");
    recipe.scene.camera = read.text("camera");
    recipe.scene.lamp = read.text("lamp");
    if (attributes.contains("abbe:time")) read.get("time", recipe.scene.time_s.emplace());
    recipe.scene.animation = read.text("animation");
    recipe.scene.variant = read.text("variant");
    recipe.scene.environment = read.text("environment");
    if (!recipe.scene.environment.empty()) {
      read.get("environmentScale", recipe.scene.environment_scale.emplace(1.0));
      read.get("environmentRotation", recipe.scene.environment_rotation_deg);
    }
    if (attributes.contains("abbe:rig")) recipe.scene.rig = rig_from_name(read.text("rig"));
    if (attributes.contains("abbe:rigTime")) {
      read.get("rigTime", recipe.scene.rig_time_s.emplace());
    }
    if (attributes.contains("abbe:emissiveLight")) {
      recipe.scene.emissive_light = emissive_light_from_name(read.text("emissiveLight"));
    }
    recipe.development = {read.text("observer", ","), read.text("white"),
                          read.text("adaptation", " ")};
    if (!recipe.development.adaptation.empty()) {
      (void)adaptation_from_name(recipe.development.adaptation);
    }
    if (attributes.contains("abbe:primaries")) recipe.color_space = read.text("primaries");
    recipe.isa = read.text("isa");
    check_settings(recipe.settings);
  } catch (const Error& error) {
    throw_input_error("", std::string("settings of another version: ") + error.what(),
                      "a file of this version");
  }
  return recipe;
}

std::map<std::string, Attribute> provenance(const PreparedScene& prepared,
                                            const RenderSettings& settings,
                                            const DevelopmentOptions& development,
                                            const Standards& standards) {
  std::map<std::string, Attribute> out = development_attributes(development, standards);
  out["abbe:version"] = std::string(ABBE_VERSION);
  out["abbe:isa"] = isa_level();
  out["abbe:complete"] = 1;
  out["abbe:mode"] = mode_name(settings.mode);

  out["abbe:illuminant"] = illuminant_text(prepared.scene);
  const bool uplifts =
      settings.mode == Mode::Spectral && !settings.frozen.contains(Cause::Reflectances);
  out["abbe:uplift"] = uplifts ? fmt::format("{}, {}", uplift_title(settings.uplift),
                                             primaries_of(prepared.scene.color_space).title)
                               : std::string("none");
  out["abbe:primaries"] = std::string(kRenderSpace);
  out["abbe:unit"] = std::string("D65 at 1 cd/m2 is 1, 1, 1");

  out["abbe:sceneHash"] = prepared.scene.content_hash;
  out["abbe:spectraHash"] = spectra_hash(prepared.scene, development, standards);
  if (!prepared.scene.name.empty()) out["abbe:scene"] = prepared.scene.name;
  out["abbe:camera"] = prepared.camera_name();
  if (!prepared.variant.empty()) out["abbe:variant"] = prepared.variant;
  if (prepared.time_s) out["abbe:time"] = *prepared.time_s;
  if (!prepared.animation.empty()) out["abbe:animation"] = prepared.animation;
  if (prepared.rig.rig != Rig::None) out["abbe:rig"] = rig_name(prepared.rig.rig);
  if (prepared.has_no_rig) out["abbe:rig"] = rig_name(Rig::None);
  if (prepared.rig_time_s && prepared.rig_time_s != prepared.time_s && !prepared.has_no_rig) {
    out["abbe:rigTime"] = *prepared.rig_time_s;
  }
  if (!prepared.environment_id.empty()) {
    out["abbe:environment"] = prepared.environment_id;
    if (prepared.environment_scale != 1.0) {
      out["abbe:environmentScale"] = prepared.environment_scale;
    }
    if (prepared.environment_rotation_deg != 0.0) {
      out["abbe:environmentRotation"] = prepared.environment_rotation_deg;
    }
  }
  if (prepared.emissive_light != LightsOthers::Auto) {
    out["abbe:emissiveLight"] = emissive_light_name(prepared.emissive_light);
  }
  if (!prepared.lamp_id.empty()) out["abbe:lamp"] = prepared.lamp_id;

  add_wavelengths(settings, out);
  out["abbe:samples"] = settings.samples_per_pixel;
  if (settings.noise > 0.0) {
    out["abbe:noise"] = settings.noise;
    out["abbe:noiseExposure"] = settings.noise_exposure_ev;
  }
  out["abbe:filter"] = settings.filter;
  out["abbe:depth"] = settings.max_depth;
  out["abbe:cutoff"] = settings.cutoff;
  out["abbe:caustics"] = std::string(settings.caustics ? "exact" : "off");
  out["abbe:chain"] = settings.inner_reflections;
  out["abbe:drop"] = settings.drop ? 1 : 0;
  if (settings.multiple_scattering) out["abbe:multipleScattering"] = 1;
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
