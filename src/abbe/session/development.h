/// How light becomes colour: observer, white and adaptation, by their names.
#pragma once

#include <map>
#include <string>

#include "abbe/color/development.h"
#include "abbe/image/image.h"
#include "abbe/session/prepare.h"

namespace abbe {

/// Names; empty: the observer CIE 1931, D65, CAT16.
struct DevelopmentChoice {
  std::string observer = {};    ///< Of the catalogue, or a .csv file of three sensitivities.
  std::string white = {};       ///< An illuminant, `x,y`, or `scene`.
  std::string adaptation = {};  ///< `cat16`, `bradford` or `none`.

  bool any() const { return !observer.empty() || !white.empty() || !adaptation.empty(); }
};

/// What the names mean. `scene` is the one that the white `scene` is of; without one, that white is
/// a usage Error.
/// Errors: a usage Error for an unknown observer, white or adaptation; an input Error for a file.
DevelopmentOptions development_options(const DevelopmentChoice& choice, const Standards& standards,
                                       const PreparedScene* scene);

/// Finds what is wrong with the names before minutes of loading: all but the white `scene`.
/// Errors: as development_options.
void check_development(const DevelopmentChoice& choice, const Standards& standards);

/// What a file says about them: `abbe:observer`, `abbe:white` and `abbe:adaptation`.
std::map<std::string, Attribute> development_attributes(const DevelopmentOptions& options,
                                                        const Standards& standards);

}  // namespace abbe
