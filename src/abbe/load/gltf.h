/// glTF 2.0 files, .gltf and .glb, into scenes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "abbe/base/notes.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// What of a file is loaded.
struct LoadOptions {
  std::optional<std::string> scene_name;  ///< Which scene of the file; default: the file's own.
  /// Posed by the file's animations at this time; absent: as the file rests.
  std::optional<double> time_s = {};
  std::string animation = {};  ///< By name, or by number from 0; empty: all of them.
  std::string variant = {};    ///< Of KHR_materials_variants, by name; empty: none.
  bool strict = false;         ///< What would be a warning is an error.
  /// About how many bytes textures may take of the memory; what is beyond lies in a PageStore.
  std::uint64_t texture_memory = std::uint64_t{1} << 30;
};

/// Reads, checks and understands a glTF file. Everything ignored or approximated becomes a note.
/// Nothing outside the scene's folder is read, but spectra of the catalogue.
/// Shape:  a scene that validate() accepts, without default lights and cameras.
/// Errors: input Error with file and JSON pointer; a usage Error for an unknown scene_name.
Scene load_gltf(const std::filesystem::path& file, const Catalogue& catalogue,
                const LoadOptions& options, Notes& notes);

}  // namespace abbe
