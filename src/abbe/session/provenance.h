/// Settings to what an EXR file says about itself, and back.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/image/exr/exr.h"
#include "abbe/image/image.h"
#include "abbe/render/settings.h"
#include "abbe/session/color_spaces.h"
#include "abbe/session/development.h"
#include "abbe/session/prepare.h"

namespace abbe {

/// All that shapes an EXR file but the contents of the scene's file.
struct Recipe {
  SceneChoice scene;
  RenderSettings settings;
  DevelopmentChoice development;
  std::string color_space = kRenderSpace;
  ExrOptions form;
  std::string isa;  ///< The level of instructions that made a file; the pixels are the same on all.
};

/// What the attributes and the form of a file say: the recipe that makes it again, of whatever file
/// the scene lies in now (its content has the hash `abbe:sceneHash`). An observer out of a .csv
/// file has the name `csv:HASH`, an environment that was chosen `image:HASH`. Absent for files that
/// no render has made, or that were developed anew. Errors: an input Error for settings of another
/// version.
std::optional<Recipe> recipe_of(const ExrHeader& header);

/// Attributes of a whole rendered image: everything that shapes it, and nothing else: no paths,
/// dates, thread counts or command lines, so that the same settings give the same bytes.
std::map<std::string, Attribute> provenance(const PreparedScene& prepared,
                                            const RenderSettings& settings,
                                            const DevelopmentOptions& development,
                                            const Standards& standards);

/// Names of the numbers in the channels objectId and materialId, of those that the image has.
std::vector<IdNames> id_names(const Scene& scene, const Image& image);

/// Settings as their attributes have them: `360:830`, `486.13,587.56`.
std::string range_text(const WavelengthOptions& wavelengths);
std::string lines_text(const WavelengthOptions& wavelengths);

}  // namespace abbe
