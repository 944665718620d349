#include "abbe/color/rgb_space.h"

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/color/color.h"

namespace abbe {

const std::vector<RgbPrimaries>& rgb_spaces() {
  static const std::vector<RgbPrimaries> spaces{
      {RgbSpace::Rec709,
       "Linear Rec.709 (sRGB)",
       "Rec.709",
       {Vec2d{0.64, 0.33}, Vec2d{0.30, 0.60}, Vec2d{0.15, 0.06}},
       kD65_xy},
      {RgbSpace::DisplayP3,
       "Linear P3-D65",
       "Display P3",
       {Vec2d{0.680, 0.320}, Vec2d{0.265, 0.690}, Vec2d{0.150, 0.060}},
       kD65_xy},
      {RgbSpace::Rec2020,
       "Linear Rec.2020",
       "Rec.2020",
       {Vec2d{0.708, 0.292}, Vec2d{0.170, 0.797}, Vec2d{0.131, 0.046}},
       kD65_xy},
      {RgbSpace::AcesCg,
       "ACEScg",
       "ACEScg (AP1)",
       {Vec2d{0.713, 0.293}, Vec2d{0.165, 0.830}, Vec2d{0.128, 0.044}},
       {0.32168, 0.33767}},
  };
  return spaces;
}

const RgbPrimaries& primaries_of(RgbSpace space) {
  return *std::find_if(rgb_spaces().begin(), rgb_spaces().end(),
                       [space](const RgbPrimaries& known) { return known.space == space; });
}

std::string rgb_space_name(RgbSpace space) {
  return primaries_of(space).name;
}

RgbSpace rgb_space_from_name(const std::string& name, const std::string& where) {
  std::vector<std::string> names;
  for (const RgbPrimaries& space : rgb_spaces()) {
    if (name == space.name) return space.space;
    names.emplace_back(space.name);
  }
  throw_input_error(where, "\"" + name + "\"", "a linear RGB space", names);
}

Mat3d rgb_to_xyz(RgbSpace space) {
  const RgbPrimaries& known = primaries_of(space);
  Mat3d matrix;
  for (int i = 0; i < 3; ++i) {
    matrix[i] = xyz_of_xy(known.primaries_xy[static_cast<std::size_t>(i)]);
  }
  // The primaries' luminances are those whose sum is white.
  const Vec3d white = xyz_of_xy(known.white_xy);
  const Vec3d luminances = glm::inverse(matrix) * white;
  for (int i = 0; i < 3; ++i) matrix[i] *= luminances[i];
  return known.white_xy == kD65_xy ? matrix
                                   : bradford_adaptation(white, xyz_of_xy(kD65_xy)) * matrix;
}

Mat3d rgb_to_rec709(RgbSpace space) {
  return space == RgbSpace::Rec709 ? Mat3d(1.0) : xyz_to_rec709() * rgb_to_xyz(space);
}

Mat3d rec709_to_rgb(RgbSpace space) {
  return glm::inverse(rgb_to_rec709(space));
}

}  // namespace abbe
