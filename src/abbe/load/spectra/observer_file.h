/// Observers by name, and cameras by files of their sensitivities.
#pragma once

#include <filesystem>
#include <string>

#include "abbe/load/spectra/catalogue.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// Three sensitivities as text: a wavelength in nm and three values a line, separated by commas,
/// semicolons, tabs or blanks; lines that begin with # are left out. The first line may name the
/// columns: where the names of the last three begin with x, y, z they are colour matching
/// functions, tristimulus values at once; all else is a camera, whose responses a fit turns into
/// tristimulus values (color/development.h). Outside its wavelengths it sees nothing. Shape:  the
/// id is `csv:` and a hash of the content, never a path. Errors: input Error with file and line.
Observer read_observer_csv(const std::filesystem::path& file, const Observer& photometer,
                           const Spectrum& d65);

/// Whether an observer of that name is one of a file of its own.
bool is_observer_file(const std::string& name);

/// An observer by name: cie1931, cie1964, the id of one in the catalogue or a file.
/// Errors: a usage Error for an unknown name, an input Error for the file.
Observer observer_named(const std::string& name, const Catalogue& catalogue,
                        const Observer& photometer, const Spectrum& d65);

}  // namespace abbe
