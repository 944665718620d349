/// The command that would make an image again.
#pragma once

#include <optional>
#include <string>

#include "abbe/image/exr/exr.h"

namespace abbe {

/// `abbe render SCENE -o OUT.exr …` with every setting that shapes the file, as its provenance and
/// its form say; SCENE is the file whose content has the hash `abbe:sceneHash`, and FILE.csv that
/// of an observer. Absent for files that no render has made, or that were developed anew.
std::optional<std::string> render_command_of(const ExrHeader& header);

}  // namespace abbe
