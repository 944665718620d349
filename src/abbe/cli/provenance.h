/// What an EXR file says about how it was made.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "abbe/cli/prepare.h"
#include "abbe/image/image.h"
#include "abbe/render/render.h"

namespace abbe {

/// Attributes of a rendered image: everything that shapes it, and nothing else: no paths, dates,
/// thread counts or command lines, so that the same settings give the same bytes.
std::map<std::string, Attribute> provenance(const PreparedScene& prepared,
                                            const RenderSettings& settings,
                                            const std::string& color_space, bool is_complete);

/// Names of the numbers in the channels objectId and materialId, of those that the image has.
std::vector<IdNames> id_names(const Scene& scene, const Image& image);

}  // namespace abbe
