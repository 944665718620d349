#include "load/catalogue.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "base/error.h"
#include "base/file.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".txt";

std::vector<fs::path> folders_of_environment() {
  std::vector<fs::path> folders;
  const char* variable = std::getenv("ABBE_SPECTRA_PATH");
  std::string rest = variable ? variable : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    if (colon != 0) folders.emplace_back(rest.substr(0, colon));
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
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
      if (file->path().extension() != kSuffix || !file->is_regular_file(status_error)) continue;
      fs::path relative = file->path().lexically_relative(folder);
      relative.replace_extension();
      files_.emplace(relative.generic_string(), file->path());
    }
  }
  for (const auto& [id, file] : files_) ids_.push_back(id);
}

std::string Catalogue::resolve(const std::string& id_or_tail, const std::string& where) const {
  if (files_.contains(id_or_tail)) return id_or_tail;
  std::vector<std::string> candidates;
  for (const std::string& id : ids_) {
    if (ends_with_component(id, id_or_tail)) candidates.push_back(id);
  }
  if (candidates.size() == 1) return candidates.front();
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
  return read_spectrum_file(files_.at(id), id);
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

}  // namespace abbe
