#include "load/catalogue.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "base/error.h"
#include "base/file.h"
#include "load/foreign_spectra.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestAgf = 16u << 20;

enum class FileFormat { None, Single, Agf };

FileFormat format_of(const fs::path& file) {
  const std::string suffix = file.extension().string();
  if (suffix == ".txt" || suffix == ".yml" || suffix == ".yaml") return FileFormat::Single;
  return suffix == ".agf" || suffix == ".AGF" ? FileFormat::Agf : FileFormat::None;
}

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
      const FileFormat format = format_of(file->path());
      if (format == FileFormat::None || !file->is_regular_file(status_error)) continue;
      fs::path relative = file->path().lexically_relative(folder);
      relative.replace_extension();
      const std::string id = relative.generic_string();
      if (format == FileFormat::Single) {
        places_.emplace(id, Place{file->path(), ""});
        continue;
      }
      const std::vector<std::uint8_t> bytes =
          read_file(file->path(), file->path().string(), kLargestAgf);
      const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      for (const std::string& glass : names_in_agf(text)) {
        places_.emplace(id + "/" + glass, Place{file->path(), glass});
      }
    }
  }
  for (const auto& [id, place] : places_) ids_.push_back(id);
}

std::string Catalogue::resolve(const std::string& id_or_tail, const std::string& where) const {
  if (places_.contains(id_or_tail)) return id_or_tail;
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

}  // namespace abbe
