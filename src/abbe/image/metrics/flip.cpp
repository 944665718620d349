#include "abbe/image/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/parallel.h"
#include "abbe/color/color.h"
#include "abbe/image/image_pair.h"

namespace abbe {
namespace {

// The parameters of the paper, named as there.
constexpr double kQc = 0.7;   // Exponent of the colour difference.
constexpr double kPc = 0.4;   // Share of the largest difference that
constexpr double kPt = 0.95;  // is mapped to this share of the error.
constexpr double kW = 0.082;  // Width of the feature detectors, in degrees.
constexpr double kQf = 0.5;   // Exponent of the feature difference.

using Plane = std::vector<double>;
using Kernel = std::vector<double>;

/// Three values per pixel, and the size they belong to.
struct Planes {
  int width = 0, height = 0;
  std::array<Plane, 3> of;

  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
};

// Sum over a row and then a column of a separable kernel; beyond the border stands its last pixel.
Plane convolved(const Plane& in, int width, int height, const Kernel& along_x,
                const Kernel& along_y) {
  const int radius_x = static_cast<int>(along_x.size()) / 2;
  const int radius_y = static_cast<int>(along_y.size()) / 2;
  Plane half(in.size()), out(in.size());
  parallel_for(0, static_cast<std::size_t>(height), 8, [&](std::size_t y) {
    const double* row = in.data() + y * static_cast<std::size_t>(width);
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int k = -radius_x; k <= radius_x; ++k) {
        sum +=
            along_x[static_cast<std::size_t>(k + radius_x)] * row[std::clamp(x + k, 0, width - 1)];
      }
      half[y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = sum;
    }
  });
  parallel_for(0, static_cast<std::size_t>(height), 8, [&](std::size_t y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int k = -radius_y; k <= radius_y; ++k) {
        const int source = std::clamp(static_cast<int>(y) + k, 0, height - 1);
        sum += along_y[static_cast<std::size_t>(k + radius_y)] *
               half[static_cast<std::size_t>(source) * width + static_cast<std::size_t>(x)];
      }
      out[y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = sum;
    }
  });
  return out;
}

Kernel gaussian(int radius, double per_pixel2) {
  Kernel kernel;
  for (int k = -radius; k <= radius; ++k) kernel.push_back(std::exp(-per_pixel2 * k * k));
  return kernel;
}

double sum_of(const Kernel& kernel) {
  double sum = 0.0;
  for (const double value : kernel) sum += value;
  return sum;
}

// Opponent colours: linear in XYZ, where L*a*b* has its roots.
Vec3d ycxcz_of_xyz(const Vec3d& xyz, const Vec3d& white) {
  const Vec3d ratio = xyz / white;
  return {116.0 * ratio.y - 16.0, 500.0 * (ratio.x - ratio.y), 200.0 * (ratio.y - ratio.z)};
}
Vec3d xyz_of_ycxcz(const Vec3d& ycxcz, const Vec3d& white) {
  const double y = (ycxcz.x + 16.0) / 116.0;
  return white * Vec3d(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0);
}

struct Whites {
  Mat3d to_xyz = rec709_to_xyz();
  Mat3d to_rec709 = xyz_to_rec709();
  Vec3d white = to_xyz * Vec3d(1.0);
};

Planes opponent_planes(const Image& image, const std::array<std::size_t, 3>& rgb,
                       const Whites& whites) {
  Planes planes{image.width, image.height, {}};
  for (Plane& plane : planes.of) plane.resize(planes.pixels());
  parallel_for(0, planes.pixels(), 4096, [&](std::size_t p) {
    Vec3d rgb_rec709(0.0);
    for (int c = 0; c < 3; ++c) {
      const double value =
          image.pixels[p * image.channel_count() + rgb[static_cast<std::size_t>(c)]];
      rgb_rec709[c] = std::isnan(value) ? 0.0 : std::clamp(value, 0.0, 1.0);
    }
    const Vec3d ycxcz = ycxcz_of_xyz(whites.to_xyz * rgb_rec709, whites.white);
    for (int c = 0; c < 3; ++c) planes.of[static_cast<std::size_t>(c)][p] = ycxcz[c];
  });
  return planes;
}

// The contrast sensitivity of each opponent channel as a sum of Gaussians a·√(π/b)·exp(−π²x²/b),
// x in degrees; table 1 of the paper.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> kSensitivities{
    {{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

void filter_as_the_eye(Planes& planes, double pixels_per_degree) {
  const int radius =
      static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * kPi * kPi)) * pixels_per_degree));
  for (std::size_t c = 0; c < 3; ++c) {
    const Sensitivity& s = kSensitivities[c];
    Plane result(planes.pixels(), 0.0);
    double total = 0.0;
    for (const auto& [a, b] : {std::pair{s.a1, s.b1}, std::pair{s.a2, s.b2}}) {
      if (a == 0.0) continue;
      const Kernel kernel =
          gaussian(radius, kPi * kPi / (b * pixels_per_degree * pixels_per_degree));
      const double amplitude = a * std::sqrt(kPi / b);
      const Plane part = convolved(planes.of[c], planes.width, planes.height, kernel, kernel);
      for (std::size_t p = 0; p < part.size(); ++p) result[p] += amplitude * part[p];
      total += amplitude * sum_of(kernel) * sum_of(kernel);
    }
    for (double& value : result) value /= total;
    planes.of[c] = std::move(result);
  }
}

// L*a*b* with the colourfulness that fades with the light (Hunt's effect).
Vec3d hunt_adjusted_lab(const Vec3d& rgb_rec709, const Whites& whites) {
  const Vec3d lab = lab_of_xyz(whites.to_xyz * rgb_rec709, whites.white);
  return {lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z};
}

double hyab(const Vec3d& a, const Vec3d& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

// Shares of the whole range: differences up to kPc of the largest take kPt of it.
double redistributed(double difference, double largest) {
  const double knee = kPc * largest;
  if (difference < knee) return kPt / knee * difference;
  return kPt + (difference - knee) / (largest - knee) * (1.0 - kPt);
}

std::vector<double> color_errors(Planes planes, Planes reference, double pixels_per_degree,
                                 const Whites& whites) {
  filter_as_the_eye(planes, pixels_per_degree);
  filter_as_the_eye(reference, pixels_per_degree);
  // Nothing on an sRGB screen lies further apart than green and blue.
  const double largest = std::pow(
      hyab(hunt_adjusted_lab({0, 1, 0}, whites), hunt_adjusted_lab({0, 0, 1}, whites)), kQc);
  std::vector<double> errors(planes.pixels());
  parallel_for(0, errors.size(), 4096, [&](std::size_t p) {
    const auto seen = [&](const Planes& from) {
      const Vec3d ycxcz(from.of[0][p], from.of[1][p], from.of[2][p]);
      return hunt_adjusted_lab(
          glm::clamp(whites.to_rec709 * xyz_of_ycxcz(ycxcz, whites.white), 0.0, 1.0), whites);
    };
    errors[p] = redistributed(std::pow(hyab(seen(planes), seen(reference)), kQc), largest);
  });
  return errors;
}

// A derivative of a Gaussian whose positive and negative weights are normalised apart.
Kernel balanced(Kernel kernel) {
  double positive = 0.0, negative = 0.0;
  for (const double value : kernel) (value > 0.0 ? positive : negative) += value;
  for (double& value : kernel) value /= value > 0.0 ? positive : -negative;
  return kernel;
}

// Strength of edges and of points in the light of an image.
struct Features {
  Plane edges, points;
};

Features features_of(const Planes& planes, double pixels_per_degree) {
  const double sigma = 0.5 * kW * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  Kernel smooth = gaussian(radius, 0.5 / (sigma * sigma));
  Kernel edge, point;
  for (int k = -radius; k <= radius; ++k) {
    const double g = smooth[static_cast<std::size_t>(k + radius)];
    edge.push_back(-k * g);
    point.push_back((k * k / (sigma * sigma) - 1.0) * g);
  }
  edge = balanced(edge);
  point = balanced(point);
  const double total = sum_of(smooth);
  for (double& value : smooth) value /= total;

  Plane light = planes.of[0];
  for (double& value : light) value = (value + 16.0) / 116.0;
  const auto magnitude = [&](const Kernel& derivative) {
    Plane along_x = convolved(light, planes.width, planes.height, derivative, smooth);
    const Plane along_y = convolved(light, planes.width, planes.height, smooth, derivative);
    for (std::size_t p = 0; p < along_x.size(); ++p)
      along_x[p] = std::hypot(along_x[p], along_y[p]);
    return along_x;
  };
  return {magnitude(edge), magnitude(point)};
}

}  // namespace

std::vector<float> flip_errors(const Image& rgb_rec709, const Image& reference_rgb_rec709,
                               double pixels_per_degree) {
  check_same_size(rgb_rec709, reference_rgb_rec709);
  const Whites whites;
  const Planes planes = opponent_planes(rgb_rec709, rgb_indices(rgb_rec709), whites);
  const Planes reference =
      opponent_planes(reference_rgb_rec709, rgb_indices(reference_rgb_rec709), whites);
  const Features features = features_of(planes, pixels_per_degree);
  const Features expected = features_of(reference, pixels_per_degree);
  const std::vector<double> color = color_errors(planes, reference, pixels_per_degree, whites);
  std::vector<float> errors(color.size());
  for (std::size_t p = 0; p < errors.size(); ++p) {
    const double feature = std::max(std::abs(features.edges[p] - expected.edges[p]),
                                    std::abs(features.points[p] - expected.points[p]));
    const double feature_error = std::pow(feature / std::sqrt(2.0), kQf);
    errors[p] = static_cast<float>(std::pow(color[p], 1.0 - feature_error));
  }
  return errors;
}

}  // namespace abbe
