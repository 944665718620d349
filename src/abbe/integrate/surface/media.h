/// The media that rays are in, and the one rule of what a surface does to them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "abbe/world/world.h"

namespace abbe {

/// The media a ray is in, as numbers of materials: those of higher priority last, among equals the
/// innermost last. The last one owns the place. Where more nest than fit, the first is forgotten.
class MediumStack {
 public:
  bool empty() const { return count_ == 0; }
  /// The medium that owns the place. Domain: not empty().
  std::uint32_t top() const { return materials_[count_ - 1]; }
  /// The same, or none: outside of all bodies.
  std::optional<std::uint32_t> owner() const {
    return empty() ? std::nullopt : std::optional(top());
  }
  bool contains(std::uint32_t material) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (materials_[i] == material) return true;
    }
    return false;
  }
  void push(std::uint32_t material, std::int16_t priority) {
    if (count_ == materials_.size()) remove_at(0);
    std::size_t i = count_++;
    for (; i > 0 && priorities_[i - 1] > priority; --i) {
      materials_[i] = materials_[i - 1];
      priorities_[i] = priorities_[i - 1];
    }
    materials_[i] = static_cast<std::uint16_t>(material);
    priorities_[i] = priority;
  }
  /// Removes the innermost entry of that material; whether there was one.
  bool remove(std::uint32_t material) {
    for (std::size_t i = count_; i-- > 0;) {
      if (materials_[i] != material) continue;
      remove_at(i);
      return true;
    }
    return false;
  }

 private:
  void remove_at(std::size_t i) {
    for (; i + 1 < count_; ++i) {
      materials_[i] = materials_[i + 1];
      priorities_[i] = priorities_[i + 1];
    }
    --count_;
  }

  std::array<std::uint16_t, 7> materials_{};
  std::array<std::int16_t, 7> priorities_{};
  std::uint16_t count_ = 0;
};

/// A face of a body as a ray meets it.
struct MetFace {
  std::uint32_t material = 0;  ///< Its number.
  std::int16_t priority = 0;
  bool front = true;  ///< Met from outside of the body.

  bool operator==(const MetFace&) const = default;
};

/// What a surface is to the media on its sides.
enum class Crossing : std::uint8_t {
  None,    ///< Opaque: there is no other side.
  Thin,    ///< A sheet in one medium.
  Enter,   ///< Into the material's medium, or from there into one in contact with it.
  Leave,   ///< Out of it.
  Hidden,  ///< The same medium owns both sides: no boundary for light.
};

/// A ray at a surface: the medium it arrives in, and those it would be in behind.
struct MediumChange {
  Crossing crossing = Crossing::None;
  std::optional<std::uint32_t> arrives_in;  ///< Number of a material; none outside of all bodies.
  MediumStack before, behind;

  /// Whether light goes on behind in its direction: there is nothing to refract it.
  bool goes_straight() const { return crossing == Crossing::Thin || crossing == Crossing::Hidden; }
  /// Whether two media meet here.
  bool is_boundary() const { return crossing == Crossing::Enter || crossing == Crossing::Leave; }
  /// The medium behind, of a surface that is a boundary. Domain: not goes_straight().
  std::optional<std::uint32_t> goes_into() const { return behind.owner(); }
};

/// THE rule of media, for the eye's rays and for shadow rays: what a surface is to a ray in `media`
/// that meets it. Of closed bodies whose faces are in contact there, `faces` has all, the surface's
/// own first: they are one boundary, from what owns the place before to what owns it behind. Of
/// bodies that overlap the one of the highest priority owns the place, among equals the one
/// entered last. A ray that meets the back of a body that its stack does not know began inside, and
/// gets out.
/// Source: Schmidt & Budge, Simple Nested Dielectrics in Ray Traced Images, jgt 7(2), 2002.
inline MediumChange cross(const MediumStack& media, Transmission transmission,
                          std::span<const MetFace> faces) {
  MediumChange change{Crossing::None, media.owner(), media, media};
  if (transmission == Transmission::None) return change;
  if (transmission == Transmission::ThinSheet) {
    change.crossing = Crossing::Thin;
    return change;
  }
  MediumStack arriving = media;
  std::uint32_t grazed =
      0;  // Bits of front faces: at an edge, a body is met on both sides at once.
  for (const MetFace& face : faces) {
    if (face.front || change.behind.remove(face.material)) continue;
    std::size_t twin = 0;
    while (twin < faces.size() && !(faces[twin].front && faces[twin].material == face.material &&
                                    ((grazed >> twin) & 1u) == 0)) {
      ++twin;
    }
    if (twin < faces.size()) {
      grazed |= 1u << twin;
    } else {
      arriving.push(face.material, face.priority);
    }
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!faces[i].front || ((grazed >> i) & 1u) != 0) continue;
    change.behind.push(faces[i].material, faces[i].priority);
  }
  change.arrives_in = arriving.owner();
  change.crossing = change.arrives_in == change.behind.owner() ? Crossing::Hidden
                    : faces.front().front                      ? Crossing::Enter
                                                               : Crossing::Leave;
  return change;
}

}  // namespace abbe
