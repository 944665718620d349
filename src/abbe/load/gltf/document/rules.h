/// The shape of a glTF 2.0 document as a table of facts, one line each.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace abbe::gltf {

/// What a value must be, and what low and high of its rule mean.
enum class Is {
  Object,
  Array,    ///< low to high elements
  Number,   ///< low to high
  Integer,  ///< low to high
  Index,    ///< into the array at `target`
  Text,
  Boolean,
};

/// One fact about a document. `path` is a JSON pointer in which * stands for every element or
/// member.
struct Rule {
  std::string path;
  Is type;
  bool required = false;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  const char* target = "";
};

/// Elements of an array, at most.
inline constexpr double kMaxElements = 4294967296.0;
/// Integers up to here are exact in double precision: 2^53.
inline constexpr double kLargestInteger = 9007199254740992.0;

/// All rules, in an order in which what a later rule walks through an earlier one has checked.
/// Source: glTF 2.0, chapter 5, and KHR_lights_punctual.
const std::vector<Rule>& structure_rules();

}  // namespace abbe::gltf
