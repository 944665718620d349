/// The shape of a glTF document: types, required members, ranges and indices, checked on the JSON
/// tree before anything is made from it.
#pragma once

#include <string>

#include "abbe/load/gltf/document/document.h"

namespace abbe::gltf {

/// Checks everything that the loader relies on, by a table of rules; integers written as 3.0 become
/// integers. Afterwards every index is in range and every number used is of its type and finite.
/// Errors: input Error with a JSON pointer.
void check_structure(Document& document);

/// Splits extensions into understood and ignored ones (each ignored one is a note).
/// Errors: input Error when a required extension is unknown.
void check_extensions(Document& document);

/// Whether the extensionsUsed or extensionsRequired of a read model list a name.
bool uses_extension(const Document& document, const std::string& name);

/// A JSON value in words, for messages: `the string "abc"`, `-1.5`, `an array of 3`.
std::string describe(const Json& value);

/// A member of an object, or nothing; of nothing, nothing.
const Json* find(const Json* object, const char* name);

/// The extension object of an element, or nothing.
const Json* find_extension(const Json& element, const char* name);
/// The same of an element of an array of the document: "nodes", 3.
const Json* find_extension(const Document& document, const char* array, int index,
                           const char* name);
/// The same of a primitive.
const Json* find_extension(const Document& document, int mesh, std::size_t primitive,
                           const char* name);

}  // namespace abbe::gltf
