// The part of a pixel that lines leave, against a fine grid in double precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <hwy/highway.h>

#include "abbe/caustics/flat/light/lit_pixel-inl.h"
#include "abbe/film/filter.h"

namespace abbe {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 4>;

PixelKernel kernel_of(const std::string& name) {
  const Filter filter = Filter::named(name);
  PixelKernel kernel;
  kernel.radius_px = filter.radius_px();
  for (int i = 0; i <= PixelKernel::kCells; ++i) {
    kernel.cumulated[static_cast<std::size_t>(i)] = static_cast<float>(
        filter.share_below((2.0 * i / PixelKernel::kCells - 1.0) * kernel.radius_px));
  }
  return kernel;
}

struct Edge {
  double height, along, across;
};

double on_a_grid(const Filter& filter, double radius, const std::vector<Edge>& edges) {
  constexpr int kSide = 1500;
  double sum = 0.0;
  for (int y = 0; y < kSide; ++y) {
    const double v = (2.0 * (y + 0.5) / kSide - 1.0) * radius;
    double row = 0.0;
    for (int x = 0; x < kSide; ++x) {
      const double u = (2.0 * (x + 0.5) / kSide - 1.0) * radius;
      bool inside = true;
      for (const Edge& e : edges) inside &= e.height + e.along * u + e.across * v >= 0.0;
      if (inside) row += filter.value(u);
    }
    sum += row * filter.value(v);
  }
  return sum * (2.0 * radius / kSide) * (2.0 * radius / kSide);
}

double by_lines(const PixelKernel& kernel, const std::vector<Edge>& edges) {
  const Tag d;
  PixelOnSurface pixel;
  pixel.radius_px = kernel.radius_px;
  pixel.cumulated = kernel.cumulated.data();
  HWY_NAMESPACE::LitArea<Tag> area(d, pixel);
  for (const Edge& e : edges) {
    area.add({hn::Set(d, static_cast<float>(e.height)), hn::Set(d, static_cast<float>(e.along)),
              hn::Set(d, static_cast<float>(e.across))});
  }
  const auto is_lit = area.integrate(d);
  return static_cast<double>(hn::GetLane(hn::IfThenElseZero(is_lit, area.share())));
}

// Convex spots of three to six edges about a place near the pixel, from slivers to all of it.
std::vector<Edge> random_spot(std::mt19937& engine) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Edge> edges;
  const int count = 3 + static_cast<int>(4.0 * unit(engine));
  const double cx = 2.0 * unit(engine) - 1.0, cy = 2.0 * unit(engine) - 1.0;
  const double size = 0.02 * std::pow(100.0, unit(engine));
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * 3.14159265358979 * (k + 0.8 * unit(engine)) / count;
    const double nx = -std::cos(angle), ny = -std::sin(angle);
    const double away = size * (0.3 + unit(engine));
    const double scale = 0.01 + unit(engine);
    edges.push_back({scale * (away - nx * cx - ny * cy), scale * nx, scale * ny});
  }
  return edges;
}

TEST(LitAreaTest, random_spots_are_as_on_a_fine_grid) {
  std::mt19937 engine(7);
  for (const char* name : {"box", "gaussian", "triangle"}) {
    const Filter filter = Filter::named(name);
    const PixelKernel kernel = kernel_of(name);
    for (int i = 0; i < 60; ++i) {
      const std::vector<Edge> edges = random_spot(engine);
      // The grid knows the place of an edge to half a cell: a few 1e-4 of a pixel. Strips of a
      // kernel that is curved are off by 7e-4.
      EXPECT_NEAR(by_lines(kernel, edges), on_a_grid(filter, kernel.radius_px, edges), 1e-3)
          << name << " " << i;
    }
  }
}

TEST(LitAreaTest, edges_along_the_pixel_and_edges_named_twice_are_exact) {
  const PixelKernel kernel = kernel_of("box");
  const std::vector<Edge> square{{0.25, 1, 0}, {0.25, -1, 0}, {0.125, 0, 2}, {0.5, 0, -2}};
  EXPECT_NEAR(by_lines(kernel, square), 0.5 * (0.0625 + 0.25), 1e-6);
  std::vector<Edge> twice = square;
  twice.insert(twice.end(), square.begin(), square.end());
  EXPECT_NEAR(by_lines(kernel, twice), 0.5 * (0.0625 + 0.25), 1e-6);
  EXPECT_EQ(by_lines(kernel, {{-0.1, 1, 0}, {-0.1, -1, 0}}), 0.0);
  EXPECT_NEAR(by_lines(kernel, {}), 1.0, 1e-6);
}

}  // namespace
}  // namespace abbe
