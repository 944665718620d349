#include "abbe/session/study.h"

#include <utility>

#include "abbe/base/error.h"
#include "abbe/session/color_spaces.h"
#include "abbe/session/picture.h"

namespace abbe {

Study::Study(const PreparedScene& prepared, const Standards& standards,
             const DevelopmentOptions& development, Options options)
    : prepared_(prepared),
      standards_(standards),
      development_(development),
      options_(std::move(options)) {}

std::optional<Image> Study::reusable(const std::filesystem::path& file,
                                     const RenderSettings& settings) const {
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
    const auto attributes = provenance(prepared_, settings, development_, standards_);
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
  if (std::optional<Image> image = reusable(path, settings)) {
    const auto took = options_.seconds.find(file);
    seconds_[file] = took != options_.seconds.end() ? took->second : 0.0;
    ++reused_;
    return StudyImage{std::move(*image), seconds_[file], true};
  }
  const StudyStep step{begun_, announced_, label};
  const StudyWatcher& watcher = options_.watcher;
  ProgressCallback progress;
  if (watcher.progress) {
    progress = [&](double fraction_done) { watcher.progress(step, fraction_done); };
  }
  Notes notes;
  Picture picture = render_picture(prepared_, settings, standards_, notes, development_, progress,
                                   options_.cancel);
  if (rendered_ == 0 && watcher.notes) watcher.notes(notes);
  if (!picture.result.complete) return std::nullopt;
  std::filesystem::create_directories(path.parent_path());
  write_exr(path, picture.image, {.chromaticities = chromaticities_of(kRenderSpace)});
  if (watcher.done) watcher.done(step, picture.result.seconds);
  seconds_[file] = picture.result.seconds;
  ++rendered_;
  return StudyImage{std::move(picture.image), picture.result.seconds, false};
}

}  // namespace abbe
