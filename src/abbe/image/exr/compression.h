/// Names of OpenEXR's compressions.
#pragma once

#include <OpenEXR/ImfCompression.h>

#include <string>

namespace abbe {

/// Domain: one of exr_compressions().
Imf::Compression exr_compression(const std::string& name);
/// "unknown" for what this OpenEXR has no name for.
std::string exr_compression_name(Imf::Compression compression);

}  // namespace abbe
