/// Images of light from all around.
#pragma once

#include <filesystem>
#include <string>

#include "abbe/base/notes.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Largest image of an environment: the texels of 16384x8192, and its values.
inline constexpr std::int64_t kMaxEnvironmentTexels = std::int64_t{1} << 27;
inline constexpr std::int64_t kMaxEnvironmentValues = std::int64_t{1} << 29;

/// Reads an equirectangular image: a spectral EXR (radiance in channels S0.…nm, in the layout of
/// Fichet et al.), else R, G, B (or a grey, Y) of an EXR, .hdr or what else OpenImageIO reads,
/// scene-linear. `chromaticities` of an EXR other than Rec.709's are converted. What of it is no
/// radiance (not finite, of negative luminance, a band below 0) becomes 0, with a warning that
/// counts it.
/// Errors: input Error at `where` for what is no such image or larger than the limits above.
EnvironmentImage read_environment_image(const std::filesystem::path& file, const std::string& where,
                                        Notes& notes);

}  // namespace abbe
