/// What the spectra of a render are, whatever they are called.
#pragma once

#include <string>

#include "abbe/color/development.h"
#include "abbe/session/prepare.h"

namespace abbe {

/// Hash of the values of every spectrum that shapes the picture of a scene: its lamps and
/// materials, the observers, D65 and the white. Files of a catalogue may change and keep their ids.
/// Shape:  16 hex digits.
std::string spectra_hash(const Scene& scene, const DevelopmentOptions& development,
                         const Standards& standards);

}  // namespace abbe
