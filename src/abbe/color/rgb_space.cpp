#include "abbe/color/rgb_space.h"

#include <algorithm>
#include <cmath>

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

namespace {

Mat3d rgb_to_xyz(const std::array<Vec2d, 3>& primaries_xy, const Vec2d& white_xy) {
  Mat3d matrix;
  for (int i = 0; i < 3; ++i) {
    matrix[i] = xyz_of_xy(primaries_xy[static_cast<std::size_t>(i)]);
  }
  // The primaries' luminances are those whose sum is white.
  const Vec3d white = xyz_of_xy(white_xy);
  const Vec3d luminances = glm::inverse(matrix) * white;
  for (int i = 0; i < 3; ++i) matrix[i] *= luminances[i];
  return white_xy == kD65_xy ? matrix : bradford_adaptation(white, xyz_of_xy(kD65_xy)) * matrix;
}

}  // namespace

Mat3d rgb_to_xyz(RgbSpace space) {
  const RgbPrimaries& known = primaries_of(space);
  return rgb_to_xyz(known.primaries_xy, known.white_xy);
}

Mat3d rgb_to_rec709(RgbSpace space) {
  return space == RgbSpace::Rec709 ? Mat3d(1.0) : xyz_to_rec709() * rgb_to_xyz(space);
}

std::optional<Mat3d> rgb_to_rec709(const std::array<Vec2d, 3>& primaries_xy,
                                   const Vec2d& white_xy) {
  constexpr double kRounding = 5e-4;  // Files print four digits at most.
  const RgbPrimaries& own = primaries_of(RgbSpace::Rec709);
  bool is_rec709 = glm::distance(white_xy, own.white_xy) < kRounding;
  bool is_color = white_xy.x > 0.0 && white_xy.y > 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    is_rec709 = is_rec709 && glm::distance(primaries_xy[i], own.primaries_xy[i]) < kRounding;
    is_color = is_color && std::abs(primaries_xy[i].y) > 1e-9;
  }
  if (is_rec709) return Mat3d(1.0);
  if (!is_color) return std::nullopt;
  const Mat3d matrix = xyz_to_rec709() * rgb_to_xyz(primaries_xy, white_xy);
  const bool is_usable = std::abs(glm::determinant(matrix)) > 1e-9;  // Not if NaN.
  return is_usable ? std::optional(matrix) : std::nullopt;
}

Mat3d rec709_to_rgb(RgbSpace space) {
  return glm::inverse(rgb_to_rec709(space));
}

}  // namespace abbe
