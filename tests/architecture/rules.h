/// The rules of the house, as functions of text, so that each can be shown to fail.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::architecture {

/// The floor of a module of src/; none for a name that is no module.
std::optional<int> floor_of(std::string_view module);

/// What is wrong with the includes of one file of src/abbe/: edges that point up or sideways,
/// headers of ours that are not named by abbe/MODULE/, headers of a third-party library outside its
/// rim, folders that are no module.
/// `path` is relative to src/abbe/, e.g. `optics/fresnel.cpp`.
std::vector<std::string> include_violations(const std::string& path, const std::string& text);

/// Headers that bring a third-party library's types out of its module: one that includes the
/// library, itself or through another header, and is included by a file of another module. `texts`
/// holds all files of src/abbe/ by path, relative to it.
std::vector<std::string> leak_violations(const std::map<std::string, std::string>& texts);

/// Parts of a module that include each other, directly or through further parts. A part is a folder
/// without folders in it; a file beside folders stands for itself. `texts` as above.
std::vector<std::string> part_violations(const std::map<std::string, std::string>& texts);

/// Folders of src/abbe/ that hold more source files side by side than anybody finds his way in.
std::vector<std::string> crowd_violations(const std::map<std::string, std::string>& texts);

/// What is wrong with the DEPENDS of a module's CMakeLists.txt: the same edges, at link time.
std::vector<std::string> link_violations(const std::string& path, const std::string& text);

/// What is wrong with a name at the top level of the repository: a folder that is not one of the
/// house.
std::vector<std::string> top_level_violations(const std::vector<std::string>& folders);

/// Lines of a text that hold an absolute path of somebody's machine.
std::vector<std::string> machine_path_violations(const std::string& path, const std::string& text);

/// File names that say nothing about their subject (utils, common, misc, helpers).
std::vector<std::string> name_violations(const std::string& path);

}  // namespace abbe::architecture
