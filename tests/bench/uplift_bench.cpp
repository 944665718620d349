/// What the uplift of a texture of 4096 x 4096 texels costs one core: like a photograph, whose
/// neighbours resemble each other, and of colours at random; of Rec.709 and of ACEScg. CPU seconds,
/// the least of three runs in turn, and the ratio to decoding sRGB, which a texture needs anyway.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "abbe/color/color.h"
#include "abbe/color/rgb_space.h"
#include "abbe/color/uplift/uplift.h"

namespace abbe::bench {
namespace {

constexpr int kSide = 4096;

std::vector<Vec3f> photograph(bool is_random, RgbSpace space) {
  const glm::mat3 to_rec709(rgb_to_rec709(space));
  std::mt19937 random(4096);
  std::uniform_real_distribution<float> uniform;
  std::vector<Vec3f> texels;
  texels.reserve(static_cast<std::size_t>(kSide) * kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      Vec3f color;
      for (int c = 0; c < 3; ++c) {
        const float wave = std::sin(0.002f * static_cast<float>(x + 2 * y) + static_cast<float>(c));
        color[c] = is_random ? uniform(random) : 0.5f + 0.4f * wave + 0.1f * uniform(random);
      }
      texels.push_back(to_rec709 * glm::clamp(color, 0.0f, 1.0f));
    }
  }
  return texels;
}

double cpu_seconds_of(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void measure(const char* name, const std::vector<Vec3f>& texels) {
  double uplift = std::numeric_limits<double>::infinity(), decode = uplift;
  volatile float sink = 0.0f;
  for (int repeat = 0; repeat < 3; ++repeat) {
    uplift = std::min(uplift, cpu_seconds_of([&] {
                        Vec3f sum(0.0f);
                        for (const Vec3f& texel : texels) sum += uplift_rec709_from_table(texel);
                        sink = sum.x;
                      }));
    decode = std::min(decode, cpu_seconds_of([&] {
                        double sum = 0.0;
                        for (const Vec3f& texel : texels) {
                          for (int c = 0; c < 3; ++c) sum += srgb_decode(std::abs(texel[c]));
                        }
                        sink = static_cast<float>(sum);
                      }));
  }
  fmt::print("{:<28} {:6.2f} s CPU, {:5.0f} ns a texel, {:.2f} of decoding sRGB\n", name, uplift,
             1e9 * uplift / static_cast<double>(texels.size()), uplift / decode);
}

}  // namespace
}  // namespace abbe::bench

int main() {
  using namespace abbe;
  using namespace abbe::bench;
  fmt::print("uplift of {0} x {0} texels\n", kSide);
  measure("Rec.709, photograph", photograph(false, RgbSpace::Rec709));
  measure("Rec.709, random colours", photograph(true, RgbSpace::Rec709));
  measure("ACEScg, photograph", photograph(false, RgbSpace::AcesCg));
  return 0;
}
