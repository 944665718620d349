#include "architecture/rules.h"

#include <algorithm>
#include <array>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace abbe::architecture {
namespace {

const std::map<std::string, int, std::less<>>& floors() {
  static const std::map<std::string, int, std::less<>> kFloors = {
      {"base", 0},    {"math", 1},    {"spectrum", 2}, {"accel", 2},     {"optics", 3},
      {"color", 3},   {"scene", 4},   {"image", 4},    {"load", 5},      {"film", 5},
      {"display", 5}, {"world", 5},   {"caustics", 6}, {"integrate", 7}, {"render", 8},
      {"session", 9}, {"report", 10}, {"cli", 11}};
  return kFloors;
}

/// A third-party library and the only modules that may include it.
struct Rim {
  const char* library;
  std::regex headers;
  std::set<std::string> modules;
};

const std::vector<Rim>& rims() {
  static const std::vector<Rim> kRims = {
      {"OpenEXR", std::regex(R"((OpenEXR/|Imath/|Imf\w*\.h|Iex\w*\.h|half\.h).*)"), {"image"}},
      {"OpenImageIO", std::regex(R"(OpenImageIO/.*)"), {"image"}},
      {"OpenColorIO", std::regex(R"(OpenColorIO/.*)"), {"display"}},
      {"tinygltf", std::regex(R"((.*/)?(tiny_gltf|tinygltf|stb_image)\w*\.h(pp)?)"), {"load"}},
      {"CLI11", std::regex(R"(CLI/.*)"), {"cli"}},
      {"nlohmann/json", std::regex(R"(nlohmann/.*)"), {"load", "report", "cli"}},
      {"Embree", std::regex(R"(embree\d*/.*)"), {}},
      {"GoogleTest", std::regex(R"((gtest|gmock|benchmark)(/|\.h).*)"), {}},
  };
  return kRims;
}

std::string module_of(const std::string& path) {
  return path.substr(0, path.find('/'));
}

std::string folder_of(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

std::string edge_complaint(const std::string& path, const std::string& from, const std::string& to,
                           const std::string& verb) {
  const int from_floor = *floor_of(from);
  const int to_floor = *floor_of(to);
  if (from == to || to_floor < from_floor) return "";
  return path + ": " + from + " (floor " + std::to_string(from_floor) + ") " + verb + " " + to +
         " (floor " + std::to_string(to_floor) + "), expected only lower floors";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string where(const std::string& path, std::size_t line_index) {
  return path + ":" + std::to_string(line_index + 1);
}

/// How every file of ours is included, and how nothing else is.
constexpr std::string_view kOurs = "abbe/";

struct Include {
  std::size_t line_index;
  bool quoted;
  bool ours;
  std::string header;  ///< Of ours relative to src/abbe/, as paths are.
};

std::vector<Include> includes_of(const std::string& text) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"].*)re");
  std::vector<Include> includes;
  const std::vector<std::string> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (lines[i].find('#') == std::string::npos || !std::regex_match(lines[i], match, kInclude))
      continue;
    const std::string header = match[2];
    const bool ours = header.starts_with(kOurs);
    includes.push_back({i, match[1] == "\"", ours, ours ? header.substr(kOurs.size()) : header});
  }
  return includes;
}

}  // namespace

std::optional<int> floor_of(std::string_view module) {
  const auto found = floors().find(module);
  if (found == floors().end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> include_violations(const std::string& path, const std::string& text) {
  const std::string module = module_of(path);
  if (!floor_of(module))
    return {path + ": src/abbe/" + module + " is no module of the floors table"};

  std::vector<std::string> violations;
  for (const auto& [line_index, quoted, ours, header] : includes_of(text)) {
    const std::string here = where(path, line_index);
    const bool in_folder = header.find('/') != std::string::npos;
    if (header.find("..") != std::string::npos)
      violations.push_back(here + ": include " + header + ", expected abbe/module/file.h");
    if (in_folder && floor_of(module_of(header))) {
      if (!ours) violations.push_back(here + ": include " + header + ", expected abbe/" + header);
      const std::string complaint = edge_complaint(here, module, module_of(header), "includes");
      if (!complaint.empty()) violations.push_back(complaint);
    } else if (ours || (in_folder && quoted)) {
      violations.push_back(here + ": include \"" + header +
                           "\" names no module; third-party headers go in <>");
    }
    for (const Rim& rim : rims())
      if (std::regex_match(header, rim.headers) && !rim.modules.contains(module))
        violations.push_back(here + ": " + rim.library + " outside its rim (" + header + ")");
  }
  return violations;
}

std::vector<std::string> leak_violations(const std::map<std::string, std::string>& texts) {
  // The library that each header carries, spread along includes until nothing changes.
  std::map<std::string, std::string> carried;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [path, text] : texts) {
      if (!path.ends_with(".h") || carried.contains(path)) continue;
      for (const Include& include : includes_of(text)) {
        const auto through = carried.find(include.header);
        if (through != carried.end()) carried[path] = through->second;
        for (const Rim& rim : rims())
          if (std::regex_match(include.header, rim.headers)) carried[path] = rim.library;
      }
      changed = changed || carried.contains(path);
    }
  }
  std::vector<std::string> violations;
  for (const auto& [path, text] : texts)
    for (const Include& include : includes_of(text)) {
      const auto header = carried.find(include.header);
      if (header != carried.end() && module_of(path) != module_of(include.header))
        violations.push_back(where(path, include.line_index) + ": " + include.header + " brings " +
                             header->second + " out of its module");
    }
  return violations;
}

std::vector<std::string> part_violations(const std::map<std::string, std::string>& texts) {
  std::set<std::string> divided;
  for (const auto& [path, text] : texts)
    if (const std::string folder = folder_of(path); folder != module_of(path))
      divided.insert(folder_of(folder));
  const auto part_of = [&](const std::string& path) {
    const std::string folder = folder_of(path);
    return divided.contains(folder) ? path : folder;
  };
  // For each part those it includes, and one place where it does; then all that it reaches.
  std::map<std::string, std::map<std::string, std::string>> reached;
  for (const auto& [path, text] : texts)
    for (const Include& include : includes_of(text)) {
      const std::string from = part_of(path);
      const std::string to = part_of(include.header);
      if (include.ours && from != to && module_of(from) == module_of(to))
        reached[from].emplace(to, where(path, include.line_index) + " includes " + include.header);
    }
  for (bool changed = true; changed;) {
    changed = false;
    for (auto& [from, parts] : reached)
      for (const auto& [to, place] : std::map(parts))
        for (const auto& [further, unused] : std::map(reached[to]))
          changed |= parts.emplace(further, place).second;
  }
  std::vector<std::string> violations;
  for (const auto& [from, parts] : reached)
    for (const auto& [to, place] : parts) {
      const auto back = reached[to].find(from);
      if (from < to && back != reached[to].end())
        violations.push_back(from + " and " + to + " include each other: " + place + ", " +
                             back->second);
    }
  return violations;
}

std::vector<std::string> crowd_violations(const std::map<std::string, std::string>& texts) {
  constexpr int kMaxFiles = 20;
  std::map<std::string, int> files;
  for (const auto& [path, text] : texts) ++files[folder_of(path)];
  std::vector<std::string> violations;
  for (const auto& [folder, count] : files)
    if (count > kMaxFiles)
      violations.push_back(folder + ": " + std::to_string(count) +
                           " source files, expected at most " + std::to_string(kMaxFiles) +
                           " side by side; what belongs together is a part");
  return violations;
}

std::vector<std::string> link_violations(const std::string& path, const std::string& text) {
  static const std::regex kModule(R"(abbe_module\(\s*(\w+)([^)]*)\))");
  static const std::regex kWord(R"([^\s]+)");
  static const std::set<std::string> kKeywords = {"DEPENDS", "EXCLUDE", "LIBRARIES",
                                                  "PUBLIC_LIBRARIES"};
  std::smatch match;
  if (!std::regex_search(text, match, kModule)) return {path + ": declares no abbe_module"};
  const std::string module = match[1];
  const std::string arguments = match[2];
  if (!floor_of(module)) return {path + ": " + module + " is no module of the floors table"};

  std::vector<std::string> violations;
  std::string keyword;
  for (auto word = std::sregex_iterator(arguments.begin(), arguments.end(), kWord);
       word != std::sregex_iterator(); ++word) {
    const std::string name = word->str();
    if (kKeywords.contains(name)) {
      keyword = name;
    } else if (keyword == "DEPENDS") {
      if (!floor_of(name)) {
        violations.push_back(path + ": links " + name + ", which is no module");
        continue;
      }
      const std::string complaint = edge_complaint(path, module, name, "links");
      if (!complaint.empty()) violations.push_back(complaint);
    }
  }
  return violations;
}

std::vector<std::string> top_level_violations(const std::vector<std::string>& folders) {
  static const std::set<std::string> kHouse = {"src",   "spectra", "scenes",
                                               "tests", "config",  ".ci"};
  std::vector<std::string> violations;
  for (const std::string& folder : folders)
    if (!kHouse.contains(folder))
      violations.push_back(folder +
                           "/: no folder of the house (.ci, config, scenes, spectra, src, "
                           "tests)");
  return violations;
}

std::vector<std::string> machine_path_violations(const std::string& path, const std::string& text) {
  // Only at the start of a path: `scenes/work/` is a folder of the project, `a/home/b` is no home.
  static const std::regex kMachinePath(R"((^|[^\w.\-/}]|file://)/(work|home|root|Users)/\w)");
  std::vector<std::string> violations;
  const std::vector<std::string> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    // Data URIs make lines of megabytes, which std::regex would match recursively.
    if (lines[i].size() > 4000) continue;
    if (std::regex_search(lines[i], kMachinePath))
      violations.push_back(where(path, i) + ": an absolute path of a machine: " + lines[i]);
  }
  return violations;
}

std::vector<std::string> name_violations(const std::string& path) {
  static const std::regex kEmptyName(R"((^|.*[/_\-])(utils?|common|misc|helpers?)([/_.\-].*|$))");
  if (std::regex_match(path, kEmptyName)) return {path + ": a name that says nothing"};
  return {};
}

}  // namespace abbe::architecture
