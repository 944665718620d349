/// Optical setups as glTF, for abbe.
#pragma once

#include <string>

#include "support/forward/setup.h"

namespace abbe::test {

/// A .gltf with its buffer inside. The camera sees the receiver, x to the right and y up; the
/// lamp's spectrum is illuminant/E, of 1 lx or 1 cd.
std::string gltf_text(const OpticalSetup& setup);

}  // namespace abbe::test
