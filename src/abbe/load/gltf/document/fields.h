/// Reading the members of extension objects, which tinygltf hands over raw.
#pragma once

#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/load/gltf/document/document.h"
#include "abbe/math/vec.h"

namespace abbe::gltf {

/// The range in which a number makes sense.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// An object of the document, with its place for messages. Members that are absent have defaults;
/// members of a wrong type are input Errors.
class Fields {
 public:
  /// Errors: input Error when `object` is none.
  Fields(Document& document, const Json& object, std::string pointer);

  bool has(const char* name) const { return object_->contains(name); }
  const Json& at(const char* name) const { return (*object_)[name]; }
  std::string pointer(const char* name) const { return pointer_ + "/" + name; }
  std::string where(const char* name) const { return document_->where(pointer(name)); }
  const std::string& pointer() const { return pointer_; }

  /// Errors: input Error when outside the range.
  double number(const char* name, double otherwise, Range range) const;
  /// Like number, but required.
  double required_number(const char* name, Range range) const;
  /// An integer of type T. Errors: input Error when it is none, or outside of the type's range.
  template <class T>
  T integer(const char* name, T otherwise) const {
    using Limits = std::numeric_limits<T>;
    return static_cast<T>(whole_number(name, otherwise, {Limits::min(), Limits::max()}));
  }
  /// A value outside the range is limited to it, with a warning.
  double limited(const char* name, double otherwise, Range range) const;
  /// Three numbers, limited likewise.
  Vec3d limited_triple(const char* name, const Vec3d& otherwise, Range range) const;
  /// An array of so many numbers. Errors: input Error, also where it is absent.
  std::vector<double> numbers(const char* name, std::size_t least, std::size_t most,
                              Range range) const;
  std::string required_text(const char* name) const;
  /// A member that is an object, if present.
  std::optional<Fields> object(const char* name) const;

  /// Warns about each member that is not in the list.
  void only(std::initializer_list<const char*> names) const;

 private:
  double whole_number(const char* name, double otherwise, Range range) const;

  Document* document_;
  const Json* object_;
  std::string pointer_;
};

/// A finite number, or an input Error at `where`.
double finite_number(const Json& value, const std::string& where, Range range);

/// Limits a value, with a warning when that changes it.
double limit(double value, Range range, const std::string& where, Notes& notes);

/// Limits each value, with one warning when that changes any.
void limit_all(std::span<double> values, Range range, const std::string& where, Notes& notes);

}  // namespace abbe::gltf
