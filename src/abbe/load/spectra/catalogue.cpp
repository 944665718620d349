#include "abbe/load/spectra/catalogue.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/load/spectra/computed.h"
#include "abbe/load/spectra/foreign.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestAgf = 16u << 20;

enum class FileFormat { None, Single, Agf };

FileFormat format_of(const fs::path& file) {
  const std::string suffix = file.extension().string();
  if (suffix == ".txt" || suffix == ".csv" || suffix == ".yml" || suffix == ".yaml") {
    return FileFormat::Single;
  }
  return suffix == ".agf" || suffix == ".AGF" ? FileFormat::Agf : FileFormat::None;
}

std::vector<fs::path> folders_of_environment() {
  std::vector<fs::path> folders;
  const char* variable = std::getenv("ABBE_SPECTRA_PATH");
  for (const std::string& folder : split(variable != nullptr ? variable : "", ':')) {
    if (!folder.empty()) folders.emplace_back(folder);
  }
  return folders;
}

bool ends_with_component(const std::string& id, const std::string& tail) {
  return id.size() > tail.size() && id.ends_with(tail) && id[id.size() - tail.size() - 1] == '/';
}

}  // namespace

Catalogue Catalogue::standard() {
  std::vector<fs::path> folders = folders_of_environment();
  const fs::path program = program_folder();
  folders.push_back(program / "spectra");
  folders.push_back(program.parent_path() / "spectra");
  folders.push_back(program.parent_path().parent_path() / "spectra");
  folders.push_back(program.parent_path() / "share/abbe/spectra");
#ifdef ABBE_SOURCE_SPECTRA
  folders.emplace_back(ABBE_SOURCE_SPECTRA);
#endif
  Catalogue catalogue(std::move(folders));
  if (catalogue.ids_.empty()) {
    throw_input_error(
        "spectra", "no folder of measured spectra",
        "one beside the program or two folders above it, in share/abbe of the install "
        "prefix, or named by ABBE_SPECTRA_PATH");
  }
  return catalogue;
}

Catalogue::Catalogue(std::vector<std::filesystem::path> folders) : folders_(std::move(folders)) {
  for (const fs::path& folder : folders_) {
    std::error_code error;
    fs::recursive_directory_iterator file(folder, fs::directory_options::skip_permission_denied,
                                          error);
    // A folder that is not there is no mistake: the standard ones are guesses.
    for (; !error && file != fs::recursive_directory_iterator(); file.increment(error)) {
      std::error_code status_error;
      if (!file->is_regular_file(status_error)) continue;
      // What one file is must not keep all others from being found.
      try {
        add(file->path(), folder);
      } catch (const Error& unreadable) {
        notes_.warn("", std::string(unreadable.what()) + "; the file is left out");
      }
    }
  }
  for (const auto& [id, place] : places_) ids_.push_back(id);
}

void Catalogue::add(const fs::path& file, const fs::path& folder) {
  const FileFormat format = format_of(file);
  if (format == FileFormat::None) return;
  fs::path relative = file.lexically_relative(folder);
  relative.replace_extension();
  const std::string id = relative.generic_string();
  if (format == FileFormat::Single) {
    places_.emplace(id, Place{file, ""});
    return;
  }
  const std::vector<std::uint8_t> bytes = read_file(file, file.string(), kLargestAgf);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::vector<std::string> glasses = names_in_agf(text);
  if (glasses.empty()) throw_input_error(file.string(), "no glass", "lines NM of an AGF catalogue");
  for (const std::string& glass : glasses) {
    places_.emplace(id + "/" + glass, Place{file, glass});
  }
}

std::optional<std::string> Catalogue::default_of(const std::string& id_or_tail) const {
  for (const std::string& id : ids_) {
    const std::size_t dash = id.find('-', id.rfind('/') + 1);
    if (dash == std::string::npos) continue;
    const std::string family = id.substr(0, dash);
    if (family != id_or_tail && !ends_with_component(family, id_or_tail)) continue;
    const Place& place = places_.at(id);
    if (read_spectrum_file(place.file, id, place.glass).is_default) return id;
  }
  return std::nullopt;
}

std::string Catalogue::resolve(const std::string& id_or_tail, const std::string& where) const {
  if (places_.contains(id_or_tail) || is_computed_id(id_or_tail, where)) return id_or_tail;
  std::vector<std::string> candidates;
  for (const std::string& id : ids_) {
    if (ends_with_component(id, id_or_tail)) candidates.push_back(id);
  }
  if (candidates.size() == 1) return candidates.front();
  if (candidates.empty()) {
    if (const auto chosen = default_of(id_or_tail)) return *chosen;
  }
  if (candidates.empty()) {
    throw_input_error(where, "spectrum \"" + id_or_tail + "\"",
                      "an id of the catalogue, of which these are nearest",
                      nearest_names(id_or_tail, ids_));
  }
  throw_input_error(where, "spectrum \"" + id_or_tail + "\", which is more than one",
                    "more of the id", candidates);
}

CatalogueEntry Catalogue::entry(const std::string& id_or_tail, const std::string& where) const {
  const std::string id = resolve(id_or_tail, where);
  if (!places_.contains(id)) return computed_entry(id, *this);
  const Place& place = places_.at(id);
  return read_spectrum_file(place.file, id, place.glass);
}

Observer Catalogue::observer(const std::string& id) const {
  const CatalogueEntry found = entry(id, "observer");
  if (!found.observer) {
    throw_input_error(found.id, "quantity " + found.quantity, "quantity observer");
  }
  return *found.observer;
}

Spectrum Catalogue::illuminant(const std::string& id) const {
  const CatalogueEntry found = entry(id, "illuminant");
  if (found.quantity != "emission") {
    throw_input_error(found.id, "quantity " + found.quantity, "quantity emission");
  }
  return *found.spectrum;
}

bool is_spectrum_path(const std::string& name) {
  const std::string suffix = fs::path(name.substr(0, name.find('#'))).extension().string();
  const bool has_suffix =
      suffix.size() >= 2 && std::all_of(suffix.begin() + 1, suffix.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
      });
  return has_suffix || name.empty() || name.front() == '/' || name.starts_with("./") ||
         name.find("..") != std::string::npos || name.find('\\') != std::string::npos ||
         name.find(':') != std::string::npos;
}

}  // namespace abbe
