/// --observer, --white and --adaptation: how light becomes colour.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "abbe/cli/prepare.h"
#include "abbe/color/development.h"
#include "abbe/image/image.h"

namespace abbe {

struct DevelopmentArguments {
  std::string observer, white, adaptation;  ///< As typed; empty: not given.

  bool any() const { return !observer.empty() || !white.empty() || !adaptation.empty(); }
};

void add_development_options(CLI::App& command, DevelopmentArguments& arguments);

/// Turns texts into options. `scene` is what `--white scene` means; without one, that white is a
/// usage Error.
/// Errors: a usage Error for an unknown observer, white or adaptation; an input Error for a file.
DevelopmentOptions development_options(const DevelopmentArguments& arguments,
                                       const Catalogue& catalogue, const Standards& standards,
                                       const PreparedScene* scene);

/// What a file says about them: `abbe:observer`, `abbe:white` and `abbe:adaptation`.
std::map<std::string, Attribute> development_attributes(const DevelopmentOptions& options,
                                                        const Standards& standards);

}  // namespace abbe
