/// One scene rendered in several ways into a folder, each way once.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "abbe/base/parallel.h"
#include "abbe/cli/console.h"
#include "abbe/cli/prepare.h"
#include "abbe/color/development.h"
#include "abbe/image/image.h"
#include "abbe/render/settings.h"

namespace abbe {

/// A render of a study.
struct StudyImage {
  Image image;           ///< With its provenance.
  double seconds = 0.0;  ///< It took, now or when it was made.
  bool is_reused = false;
};

/// Renders into EXR files and reuses those that stand: a file whose provenance, size and window are
/// what this render would write, and that is complete, is not made again.
class Study {
 public:
  struct Options {
    std::filesystem::path folder;
    bool fresh = false;  ///< Reuse nothing.
    const CancelFlag* cancel = nullptr;
    /// What renders took when the folder was last worked on, by file.
    std::map<std::string, double> seconds = {};
  };

  Study(const PreparedScene& prepared, const Standards& standards,
        const DevelopmentOptions& development, const Console& console, Options options);

  /// Renders still to come, for the progress line.
  void announce(int renders) { announced_ += renders; }

  /// The render with these settings, in `file` of the folder. Nothing when it was interrupted: no
  /// file is written then. `label` names it to the user.
  /// Errors: an output Error.
  std::optional<StudyImage> render(const std::string& file, const std::string& label,
                                   const RenderSettings& settings);

  /// What every render of this study took, by file.
  const std::map<std::string, double>& seconds() const { return seconds_; }
  int reused_count() const { return reused_; }
  int rendered_count() const { return rendered_; }

 private:
  std::optional<Image> reusable(const std::filesystem::path& file, const RenderSettings& settings,
                                const std::map<std::string, Attribute>& attributes) const;

  const PreparedScene& prepared_;
  const Standards& standards_;
  const DevelopmentOptions& development_;
  const Console& console_;
  Options options_;
  std::map<std::string, double> seconds_;
  int announced_ = 0, begun_ = 0, reused_ = 0, rendered_ = 0;
  bool has_shown_notes_ = false;
};

}  // namespace abbe
