/// Linear RGB spaces in which the colours of a scene may be given.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// Which linear RGB space a colour is in.
enum class RgbSpace {
  Rec709,     ///< ITU-R BT.709-6; glTF's own.
  DisplayP3,  ///< SMPTE EG 432-1 primaries, white D65.
  Rec2020,    ///< ITU-R BT.2020-2.
  AcesCg,     ///< AP1 of Academy S-2014-004; white near D60.
};

/// Chromaticities of a space.
struct RgbPrimaries {
  RgbSpace space;
  const char* name;   ///< As OpenColorIO's ACES configurations have it.
  const char* title;  ///< As people call its gamut.
  std::array<Vec2d, 3> primaries_xy;
  Vec2d white_xy;
};

/// All spaces, Rec.709 first.
const std::vector<RgbPrimaries>& rgb_spaces();

/// The row of rgb_spaces() for a space.
const RgbPrimaries& primaries_of(RgbSpace space);

/// The name of a space, and a space by its name. Errors: an input Error at `where` that lists them.
std::string rgb_space_name(RgbSpace space);
RgbSpace rgb_space_from_name(const std::string& name, const std::string& where);

/// Linear RGB of a space to XYZ relative to xy 0.3127, 0.3290: another white is adapted to it
/// (Bradford, as OpenColorIO does), so that 1, 1, 1 is 1, 1, 1 of Rec.709.
Mat3d rgb_to_xyz(RgbSpace space);

/// Between a space and linear Rec.709, in which what lies beyond its gamut has negative channels or
/// channels above 1.
Mat3d rgb_to_rec709(RgbSpace space);
Mat3d rec709_to_rgb(RgbSpace space);

/// Linear RGB of any primaries and white to linear Rec.709, adapted as in rgb_to_xyz; the identity
/// where they are those of Rec.709 but for rounding. Absent where they span no colours.
std::optional<Mat3d> rgb_to_rec709(const std::array<Vec2d, 3>& primaries_xy, const Vec2d& white_xy);

}  // namespace abbe
