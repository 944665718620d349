/// From a prepared scene to a picture.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "abbe/base/error.h"
#include "abbe/image/image.h"
#include "abbe/render/render.h"
#include "abbe/session/provenance.h"
#include "abbe/world/world.h"

namespace abbe {

/// The scene made ready to trace for these settings.
/// Errors: as check_settings and abbe::make_lit_world of a scene.
LitWorld make_lit_world(const PreparedScene& prepared, const RenderSettings& settings,
                        const Standards& standards, Notes& notes,
                        const DevelopmentOptions& development = {});

/// What a film has gathered, as an image that says how it was made: with its provenance as
/// attributes.
/// Domain: `world` was made of the scene for the same settings.
Image developed_picture(const Film& film, const World& world, const PreparedScene& prepared,
                        std::map<std::string, Attribute> provenance, bool is_complete);

/// A render as an image: R, G and B (linear Rec.709), spectral channels and extra channels, with
/// its provenance as attributes.
struct Picture {
  Image image;
  RenderResult result;
};

/// Renders a prepared scene. The same settings give the same pixels, and the same bytes in a file,
/// on every machine and for any number of threads.
/// Errors: a usage Error that names the field of a setting that cannot be.
Picture render_picture(const PreparedScene& prepared, const RenderSettings& settings,
                       const Standards& standards, Notes& notes,
                       const DevelopmentOptions& development = {},
                       const ProgressCallback& progress = {}, const CancelFlag* cancel = nullptr);

/// Renders what a recipe says of its scene into an EXR file. Returns whether it did: an interrupted
/// render leaves no file.
/// Errors: as development_options, render_picture and write_exr.
bool render_file(const Recipe& recipe, const PreparedScene& prepared, const Standards& standards,
                 const std::filesystem::path& file, Notes& notes,
                 const CancelFlag* cancel = nullptr);

}  // namespace abbe
