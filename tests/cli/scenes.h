/// Scenes for the tests of the program, as glTF texts without buffers.
#pragma once

#include <string>

namespace abbe::test {

/// A ball of N-SF11 before a red one, a lamp of 100 cd and a camera "eye".
std::string small_scene();

/// The glass ball alone: no light, no camera.
std::string dark_scene();

/// A 60° prism of N-SF11, met by an orthographic camera's rays in minimum deviation for the d line:
/// 63.1713° on the entrance face. The middle of the image goes through the middle of both faces.
std::string prism_scene();

/// A right-angled prism of N-SF11: the camera's rays enter its front face at 0° and meet the
/// oblique one from within at 45°, beyond the critical angle of 34.08°.
std::string right_angle_prism_scene();

/// A grey wall, without light, whose vertices have an alpha of 0.3 and its material a cutoff of
/// 0.3.
std::string mask_scene();

}  // namespace abbe::test
