/// From the fields of settings, by which the library names what is wrong, to the options by which
/// they are typed.
#pragma once

#include "abbe/base/error.h"

namespace abbe {

/// The Error with options where it names fields: of settings at its place, and between back quotes
/// in its texts.
Error with_options(const Error& error);

}  // namespace abbe
