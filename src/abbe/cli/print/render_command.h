/// The command that would make an image again.
#pragma once

#include <string>

#include "abbe/session/provenance.h"

namespace abbe {

/// `abbe render SCENE -o OUT.exr …` with every setting that shapes the file, behind the level of
/// instructions where the recipe names one. SCENE stands for the scene's file if the recipe has
/// none, FILE.csv for that of an observer, IMAGE for that of an environment.
std::string render_command(const Recipe& recipe);

}  // namespace abbe
