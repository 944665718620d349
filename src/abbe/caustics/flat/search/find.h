/// The search for all light that goes over flat facets.
#pragma once

#include "abbe/base/notes.h"
#include "abbe/caustics/flat/flat_caustics.h"

namespace abbe {

/// Finds the flat bodies of a scene and the chains of its lights. A body that has too many chains
/// is left to straight shadow rays, with one warning that names it. Without options.exact nothing
/// is found.
/// Domain: `tables` are of the same scene.
FlatCaustics find_flat_caustics(const Scene& scene, const TabulatedScene& tables,
                                const CausticOptions& options, Notes& notes);

}  // namespace abbe
