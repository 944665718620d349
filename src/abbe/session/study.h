/// One scene rendered in several ways into a folder, each way once.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "abbe/base/parallel.h"
#include "abbe/image/image.h"
#include "abbe/render/settings.h"
#include "abbe/session/development.h"
#include "abbe/session/prepare.h"

namespace abbe {

/// A render of a study.
struct StudyImage {
  Image image;           ///< With its provenance.
  double seconds = 0.0;  ///< It took, now or when it was made.
  bool is_reused = false;
};

/// Which of its renders a study is at.
struct StudyStep {
  int number = 0, count = 0;  ///< From 1; of those announced.
  std::string label;          ///< For people.
};

/// Told what a study does; each may be empty.
struct StudyWatcher {
  std::function<void(const Notes& notes)> notes;  ///< Of the first scene made ready.
  std::function<void(const StudyStep& step, double fraction_done)> progress;
  std::function<void(const StudyStep& step, double seconds)> done;  ///< Not of what is reused.
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
    StudyWatcher watcher = {};
  };

  /// Shape: what is passed by reference has to live as long as the study.
  Study(const PreparedScene& prepared, const Standards& standards,
        const DevelopmentOptions& development, Options options);

  const PreparedScene& prepared() const { return prepared_; }
  const Standards& standards() const { return standards_; }

  /// Renders still to come, for StudyStep::count.
  void announce(int renders) { announced_ += renders; }

  /// The render with these settings, in `file` of the folder. Nothing when it was interrupted: no
  /// file is written then. `label` names it to people.
  /// Errors: an output Error.
  std::optional<StudyImage> render(const std::string& file, const std::string& label,
                                   const RenderSettings& settings);

  /// What every render of this study took, by file.
  const std::map<std::string, double>& seconds() const { return seconds_; }
  int reused_count() const { return reused_; }
  int rendered_count() const { return rendered_; }

 private:
  std::optional<Image> reusable(const std::filesystem::path& file,
                                const RenderSettings& settings) const;

  const PreparedScene& prepared_;
  const Standards& standards_;
  const DevelopmentOptions& development_;
  Options options_;
  std::map<std::string, double> seconds_;
  int announced_ = 0, begun_ = 0, reused_ = 0, rendered_ = 0;
};

}  // namespace abbe
