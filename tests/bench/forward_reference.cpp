/// Prints the irradiances that tests of exact light keep, by brute force: 10⁸ rays forward from the
/// lamp per wavelength.
///
///   abbe_forward_reference [RAYS]
#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "abbe/base/constants.h"
#include "support/caustic_scenes.h"
#include "support/newton.h"

namespace abbe::test {
namespace {

void print_floor(const CausticScene& scene, std::uint64_t rays) {
  const ForwardLight light =
      follow_forward(scene.scene, scene.lamp, {0, -1, 0}, scene.half_angle_rad, kLine_d_nm, 1, rays,
                     scene.screen());
  fmt::print("{}: on glass {:.6f} sr, on the floor {:.6f} sr\n", scene.name, light.on_glass_sr,
             light.on_screen_sr);
  for (std::size_t i = 0; i < light.irradiance.size(); ++i) {
    fmt::print("{:.6f},{}", light.irradiance[i], i % 8 == 7 ? "\n" : " ");
  }
}

void print_newton(const char* glass, std::uint64_t rays) {
  const Newton n = newton_with_slit(glass);
  Screen screen;
  screen.center = n.screen_center;
  screen.x = n.screen_x;
  screen.y = glm::cross(n.screen_x, n.screen_normal);
  screen.pixel_m = n.pixel_m;
  screen.size = n.size;
  for (const double line_nm : {kLineF_nm, kLine_d_nm, kLineC_nm}) {
    // A cone that holds the slit.
    const ForwardLight light =
        follow_forward(n.scene, n.lamp, n.beam_direction, 0.0204, line_nm, 1, rays, screen);
    std::vector<double> columns(static_cast<std::size_t>(n.size.x), 0.0);
    double sum = 0.0, moment = 0.0;
    for (int y = 0; y < n.size.y; ++y) {
      for (int x = 0; x < n.size.x; ++x) {
        const double e = light.irradiance[static_cast<std::size_t>(y * n.size.x + x)];
        columns[static_cast<std::size_t>(x)] += e / n.size.y;
        sum += e;
        moment += e * (x + 0.5 - 0.5 * n.size.x);
      }
    }
    const double middle = moment / sum;
    const int first = static_cast<int>(middle + 0.5 * n.size.x) - 1;
    double plateau = 0.0;
    for (int x = first; x < first + 3; ++x) plateau += columns[static_cast<std::size_t>(x)] / 3.0;
    fmt::print("{} {:.4f} nm: middle {:.4f} px, flux {:.6e} sr, columns {} to {}: {:.6f} per m2\n",
               glass, line_nm, middle, sum * n.pixel_m * n.pixel_m, first, first + 2, plateau);
  }
}

int run(int argc, char** argv) {
  const std::uint64_t rays = argc > 1 ? std::stoull(argv[1]) : 100000000u;
  for (const char* glass : {"glass/schott/N-BK7", "glass/schott/N-SF11"}) print_newton(glass, rays);
  print_floor(cube_over_floor(), rays);
  print_floor(wedge_over_floor(), rays);
  print_floor(gem_over_floor(), rays);
  return 0;
}

}  // namespace
}  // namespace abbe::test

int main(int argc, char** argv) {
  return abbe::test::run(argc, argv);
}
