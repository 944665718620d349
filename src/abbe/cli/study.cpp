#include "abbe/cli/study.h"

#include <fmt/format.h>

#include <utility>

#include "abbe/base/error.h"
#include "abbe/cli/development_options.h"
#include "abbe/cli/outputs.h"
#include "abbe/cli/progress.h"
#include "abbe/cli/provenance.h"
#include "abbe/image/exr/exr.h"
#include "abbe/render/render.h"

namespace abbe {

Study::Study(const PreparedScene& prepared, const Standards& standards,
             const DevelopmentOptions& development, const Console& console, Options options)
    : prepared_(prepared),
      standards_(standards),
      development_(development),
      console_(console),
      options_(std::move(options)) {}

std::optional<Image> Study::reusable(const std::filesystem::path& file,
                                     const RenderSettings& settings,
                                     const std::map<std::string, Attribute>& attributes) const {
  if (options_.fresh || !std::filesystem::exists(file)) return std::nullopt;
  try {
    const ExrHeader header = read_exr_header(file);
    const Vec2i full =
        header.full_size == Vec2i(0) ? Vec2i(header.width, header.height) : header.full_size;
    const PixelRect window =
        settings.crop.value_or(PixelRect{0, 0, settings.size.x, settings.size.y});
    if (full != settings.size || header.width != window.width() ||
        header.height != window.height() || header.data_origin != Vec2i(window.x0, window.y0)) {
      return std::nullopt;
    }
    for (const auto& [name, value] : attributes) {
      const auto found = header.attributes.find(name);
      if (found == header.attributes.end() || found->second != value) return std::nullopt;
    }
    // What was made with more settings than these, as with frozen causes, is another image.
    for (const auto& [name, value] : header.attributes) {
      if (name.starts_with("abbe:") && !attributes.contains(name)) return std::nullopt;
    }
    return read_exr(file);
  } catch (const Error&) {
    // Whatever stands there is none of ours.
    return std::nullopt;
  }
}

std::optional<StudyImage> Study::render(const std::string& file, const std::string& label,
                                        const RenderSettings& settings) {
  ++begun_;
  const std::filesystem::path path = options_.folder / file;
  std::map<std::string, Attribute> attributes = provenance(prepared_, settings, kRenderSpace, true);
  attributes.merge(development_attributes(development_, standards_));
  if (std::optional<Image> image = reusable(path, settings, attributes)) {
    const auto took = options_.seconds.find(file);
    seconds_[file] = took != options_.seconds.end() ? took->second : 0.0;
    ++reused_;
    return StudyImage{std::move(*image), seconds_[file], true};
  }
  Notes notes;
  WorldOptions world_of = world_options(settings);
  world_of.development = development_;
  const World world =
      make_world(prepared_.scene, world_of, standards_.observer, standards_.d65, notes);
  if (!has_shown_notes_) console_.show(notes);
  has_shown_notes_ = true;
  const std::string place = fmt::format("{} of {}, {}", begun_, announced_, label);
  ProgressLine progress(console_.is_live(), place);
  RenderResult result = abbe::render(
      world, prepared_.chosen_camera(), settings,
      [&progress](double fraction_done) { progress.update(fraction_done); }, options_.cancel);
  progress.wipe();
  if (!result.complete) return std::nullopt;
  result.image.attributes = std::move(attributes);
  std::filesystem::create_directories(path.parent_path());
  ExrOptions exr;
  exr.chromaticities = chromaticities_of(kRenderSpace);
  write_exr(path, result.image, exr);
  console_.say(fmt::format("{}: {:.1f} s", place, result.seconds));
  seconds_[file] = result.seconds;
  ++rendered_;
  return StudyImage{std::move(result.image), result.seconds, false};
}

}  // namespace abbe
