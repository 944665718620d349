#include "abbe/load/gltf/document/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"

namespace abbe::gltf {
namespace {

std::string words(Range range) {
  if (std::isinf(range.low) && std::isinf(range.high)) return "a number";
  if (std::isinf(range.high)) return fmt::format("a number of at least {:g}", range.low);
  if (std::isinf(range.low)) return fmt::format("a number of at most {:g}", range.high);
  return fmt::format("a number from {:g} to {:g}", range.low, range.high);
}

}  // namespace

double finite_number(const Json& value, const std::string& where, Range range) {
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!std::isfinite(number) || number < range.low || number > range.high) {
    throw_input_error(where, describe(value), words(range));
  }
  return number;
}

void limit_all(std::span<double> values, Range range, const std::string& where, Notes& notes) {
  std::string found;
  bool is_changed = false;
  for (double& value : values) {
    found += fmt::format("{}{:g}", found.empty() ? "" : ", ", value);
    const double limited = std::clamp(value, range.low, range.high);
    is_changed = is_changed || limited != value;
    value = limited;
  }
  if (is_changed) {
    notes.warn(where,
               fmt::format("{} is outside {:g} to {:g}; limited", found, range.low, range.high));
  }
}

double limit(double value, Range range, const std::string& where, Notes& notes) {
  limit_all({&value, 1}, range, where, notes);
  return value;
}

Fields::Fields(Document& document, const Json& object, std::string pointer)
    : document_(&document), object_(&object), pointer_(std::move(pointer)) {
  if (!object.is_object()) {
    throw_input_error(document.where(pointer_), describe(object), "an object");
  }
}

double Fields::number(const char* name, double otherwise, Range range) const {
  return has(name) ? finite_number(at(name), where(name), range) : otherwise;
}

double Fields::required_number(const char* name, Range range) const {
  if (!has(name)) {
    throw_input_error(document_->where(pointer_), fmt::format("no \"{}\"", name), words(range));
  }
  return finite_number(at(name), where(name), range);
}

double Fields::whole_number(const char* name, double otherwise, Range range) const {
  const double value = number(name, otherwise, range);
  if (value != std::floor(value)) {
    throw_input_error(where(name), describe(at(name)),
                      fmt::format("an integer from {:.0f} to {:.0f}", range.low, range.high));
  }
  return value;
}

double Fields::limited(const char* name, double otherwise, Range range) const {
  if (!has(name)) return otherwise;
  return limit(finite_number(at(name), where(name), {}), range, where(name), document_->notes());
}

Vec3d Fields::limited_triple(const char* name, const Vec3d& otherwise, Range range) const {
  if (!has(name)) return otherwise;
  std::vector<double> values = numbers(name, 3, 3, {});
  limit_all(values, range, where(name), document_->notes());
  return {values[0], values[1], values[2]};
}

std::vector<double> Fields::numbers(const char* name, std::size_t least, std::size_t most,
                                    Range range) const {
  const Json* value = has(name) ? &at(name) : nullptr;
  if (value == nullptr || !value->is_array() || value->size() < least || value->size() > most) {
    throw_input_error(where(name), value == nullptr ? "nothing" : describe(*value),
                      fmt::format("an array of {}{} numbers", least,
                                  least == most ? "" : fmt::format(" to {}", most)));
  }
  std::vector<double> result;
  for (const Json& number : *value) {
    result.push_back(
        finite_number(number, fmt::format("{}/{}", where(name), result.size()), range));
  }
  return result;
}

std::string Fields::required_text(const char* name) const {
  if (!has(name)) {
    throw_input_error(document_->where(pointer_), fmt::format("no \"{}\"", name), "a string");
  }
  if (!at(name).is_string()) throw_input_error(where(name), describe(at(name)), "a string");
  return at(name).get<std::string>();
}

std::optional<Fields> Fields::object(const char* name) const {
  if (!has(name)) return std::nullopt;
  return Fields(*document_, at(name), pointer(name));
}

void Fields::only(std::initializer_list<const char*> names) const {
  for (const auto& [name, value] : object_->items()) {
    const bool is_known = std::any_of(names.begin(), names.end(),
                                      [&key = name](const char* known) { return key == known; }) ||
                          name == "extras" || name == "extensions";
    if (is_known) continue;
    std::string list;
    for (const char* known : names) list += (list.empty() ? "" : ", ") + std::string(known);
    document_->notes().warn(document_->where(pointer_ + "/" + name),
                            fmt::format("not understood; ignored (known here: {})", list));
  }
}

}  // namespace abbe::gltf
