/// The media that rays are in, and the one rule of what a surface does to them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "abbe/world/world.h"

namespace abbe {

/// The media a ray is in, innermost last: numbers of materials. Where more nest than fit, the
/// outermost is forgotten.
class MediumStack {
 public:
  bool empty() const { return count_ == 0; }
  /// Domain: not empty().
  std::uint32_t top() const { return materials_[count_ - 1]; }
  /// The innermost medium, or none: outside of all bodies.
  std::optional<std::uint32_t> innermost() const {
    return empty() ? std::nullopt : std::optional(top());
  }
  bool contains(std::uint32_t material) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (materials_[i] == material) return true;
    }
    return false;
  }
  void push(std::uint32_t material) {
    if (count_ == materials_.size()) remove_at(0);
    materials_[count_++] = static_cast<std::uint16_t>(material);
  }
  /// Removes the innermost entry of that material, if there is one.
  void remove(std::uint32_t material) {
    for (std::size_t i = count_; i-- > 0;) {
      if (materials_[i] == material) return remove_at(i);
    }
  }

 private:
  void remove_at(std::size_t i) {
    for (; i + 1 < count_; ++i) materials_[i] = materials_[i + 1];
    --count_;
  }

  std::array<std::uint16_t, 7> materials_{};
  std::uint16_t count_ = 0;
};

/// What a surface is to the media on its sides.
enum class Crossing : std::uint8_t {
  None,    ///< Opaque: there is no other side.
  Thin,    ///< A sheet in one medium.
  Enter,   ///< Into the material's medium.
  Leave,   ///< Out of it.
  Hidden,  ///< Out of a medium inside which another one has begun: no boundary for light.
};

/// A ray at a surface: the medium it arrives in, and those it would be in behind.
struct MediumChange {
  Crossing crossing = Crossing::None;
  std::optional<std::uint32_t> arrives_in;  ///< Number of a material; none outside of all bodies.
  MediumStack before, behind;

  /// Whether light goes on behind in its direction: there is nothing to refract it.
  bool goes_straight() const { return crossing == Crossing::Thin || crossing == Crossing::Hidden; }
  /// The medium behind, of a surface that is a boundary. Domain: not goes_straight().
  std::optional<std::uint32_t> goes_into() const { return behind.innermost(); }
};

/// THE rule of media, for the eye's rays and for shadow rays: what a surface of that material, met
/// from its front or back by a ray in `media`, is to them. A ray that meets the back of a body that
/// its stack does not know began inside, and gets out.
inline MediumChange cross(const MediumStack& media, std::uint32_t material,
                          Transmission transmission, bool front) {
  MediumChange change{Crossing::None, media.innermost(), media, media};
  if (transmission == Transmission::ThinSheet) {
    change.crossing = Crossing::Thin;
  } else if (transmission == Transmission::Medium && front) {
    change.crossing = Crossing::Enter;
    change.behind.push(material);
  } else if (transmission == Transmission::Medium) {
    const bool began_inside = !media.contains(material);
    if (began_inside) change.arrives_in = material;
    change.crossing = began_inside || media.top() == material ? Crossing::Leave : Crossing::Hidden;
    change.behind.remove(material);
  }
  return change;
}

}  // namespace abbe
