#include "abbe/color/development.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/error.h"
#include "abbe/color/uplift/uplift.h"

namespace abbe {
namespace {

Mat3d adapted_to_d65(const Vec3d& xyz_white, Adaptation adaptation) {
  const Vec3d to = xyz_of_xy(kD65_xy);
  switch (adaptation) {
    case Adaptation::Cat16:
      return cat16_adaptation(xyz_white, to);
    case Adaptation::Bradford:
      return bradford_adaptation(xyz_white, to);
    case Adaptation::None:
      break;
  }
  return Mat3d(1.0);
}

const std::vector<std::string> kAdaptationNames{"cat16", "bradford", "none"};  // In their order.

const Observer& observer_of(const DevelopmentOptions& options, const Observer& photometer) {
  return options.observer ? *options.observer : photometer;
}

// Tristimulus values, by the observer, of light of 1 cd/m²: lamps by their shares.
Vec3d xyz_of_unit_light(const std::vector<std::pair<Spectrum, double>>& lamps,
                        const Observer& observer, const Observer& photometer) {
  Vec3d sum(0.0);
  double total = 0.0;
  for (const auto& [lamp, share] : lamps) {
    const double luminance = xyz_of(lamp, photometer).y;
    if (!(luminance > 0.0) || !(share > 0.0)) continue;
    sum += share / luminance * xyz_of(lamp, observer);
    total += share;
  }
  return total > 0.0 ? sum / total : Vec3d(0.0);
}

}  // namespace

Adaptation adaptation_from_name(const std::string& name) {
  return static_cast<Adaptation>(
      check_choice("adaptation", name, "an adaptation", kAdaptationNames));
}

std::string adaptation_name(Adaptation adaptation) {
  return kAdaptationNames[static_cast<std::size_t>(adaptation)];
}

Mat3d responses_to_rec709(const DevelopmentOptions& options, const Observer& photometer,
                          const Spectrum& d65) {
  const Observer& observer = observer_of(options, photometer);
  const Vec3d xyz_d65 = xyz_of_unit_light({{d65, 1.0}}, observer, photometer);
  Vec3d white = xyz_d65;
  if (options.white && options.white->xy) {
    white = xyz_d65.y * xyz_of_xy(*options.white->xy);
  } else if (options.white) {
    const Vec3d of_lamps = xyz_of_unit_light(options.white->lamps, observer, photometer);
    if (of_lamps.y > 0.0) white = of_lamps;
  }
  return xyz_to_rec709() * adapted_to_d65(white / white.y, options.adaptation) *
         (1.0 / white.y * observer.responses_to_xyz);
}

Mat3d rec709_to_rec709(const DevelopmentOptions& options, const Observer& photometer,
                       const Spectrum& d65) {
  if (!options.white || options.adaptation == Adaptation::None) return Mat3d(1.0);
  Vec3d white = xyz_of_xy(kD65_xy);
  if (options.white->xy) {
    white = xyz_of_xy(*options.white->xy);
  } else {
    // As that light looks in an RGB mode.
    DevelopmentOptions of_d65 = options;
    of_d65.white.reset();
    const Observer& observer = observer_of(options, photometer);
    const Vec3d responses = glm::inverse(observer.responses_to_xyz) *
                            xyz_of_unit_light(options.white->lamps, observer, photometer);
    const Vec3d seen = rec709_to_xyz() * (responses_to_rec709(of_d65, photometer, d65) * responses);
    if (seen.y > 0.0) white = seen;
  }
  return xyz_to_rec709() * adapted_to_d65(white / white.y, options.adaptation) *
         (1.0 / white.y * rec709_to_xyz());
}

SensorFit fit_sensor(const Observer& sensor, const Observer& photometer, const Spectrum& d65) {
  const Vec3d white = xyz_of(d65, photometer);
  const Vec3d white_responses = responses_of(d65, sensor) / white.y;
  const Vec3d xyz_white = white / white.y;
  std::vector<Vec3d> responses, colors;
  constexpr int kSteps = 5;
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    const auto level = [](int step) { return 0.05 + 0.9 * step / (kSteps - 1); };
    const Vec3d rgb_rec709(level(i % kSteps), level(i / kSteps % kSteps),
                           level(i / kSteps / kSteps));
    const Spectrum seen = product(Spectrum::sigmoid(uplift_rec709(rgb_rec709)), d65);
    responses.push_back(responses_of(seen, sensor) / white.y);
    colors.push_back(xyz_of(seen, photometer) / white.y);
  }

  // For each row m of the matrix: least Σ (m·r − x)² under m·w = x_w. With A = Σ r rᵀ and
  // b = Σ x r, m = A⁻¹ (b + μ w), μ such that the white is met.
  Mat3d A(0.0);
  for (const Vec3d& r : responses) A += glm::outerProduct(r, r);
  const double scale = A[0][0] * A[1][1] * A[2][2];
  // Three curves of one shape leave a determinant of rounding errors.
  if (!(std::abs(glm::determinant(A)) > 1e-12 * scale)) {
    throw_input_error(sensor.id, "sensitivities that are not independent of each other",
                      "three different curves");
  }
  const Mat3d inverse = glm::inverse(A);
  const Vec3d toward_white = inverse * white_responses;
  Mat3d rows(0.0);
  for (int row = 0; row < 3; ++row) {
    Vec3d b(0.0);
    for (std::size_t k = 0; k < colors.size(); ++k) b += colors[k][row] * responses[k];
    const Vec3d free = inverse * b;
    const double missing = xyz_white[row] - glm::dot(free, white_responses);
    rows[row] = free + missing / glm::dot(toward_white, white_responses) * toward_white;
  }

  SensorFit fit;
  fit.responses_to_xyz = glm::transpose(rows);
  for (std::size_t k = 0; k < colors.size(); ++k) {
    const double difference =
        delta_e2000(lab_of_xyz(fit.responses_to_xyz * responses[k], xyz_white),
                    lab_of_xyz(colors[k], xyz_white));
    fit.mean_delta_e2000 += difference / static_cast<double>(colors.size());
    fit.max_delta_e2000 = std::max(fit.max_delta_e2000, difference);
  }
  return fit;
}

}  // namespace abbe
