// Makes the data of color/uplift.cpp from the measured observer and illuminant, as C++ source.
// Arguments: the observer's file, D65's file, the file to write.
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/constants.h"
#include "base/parallel.h"
#include "color/color.h"
#include "color/uplift_fit.h"
#include "color/uplift_table.h"

namespace {

using namespace abbe;

// The rows of a file of spectra/, whose format the module load checks; here a look is enough.
std::vector<std::vector<double>> columns_of(const std::string& file, std::size_t count) {
  std::ifstream stream(file);
  std::vector<std::vector<double>> columns(count);
  bool in_rows = false;
  for (std::string line; std::getline(stream, line);) {
    if (in_rows) {
      std::istringstream row(line);
      for (std::vector<double>& column : columns) {
        double value = 0.0;
        if (row >> value) column.push_back(value);
      }
    }
    in_rows = in_rows || line.rfind("columns:", 0) == 0;
  }
  if (columns.front().empty()) throw std::runtime_error(file + ": no rows");
  return columns;
}

Spectrum curve(const std::vector<std::vector<double>>& columns, std::size_t column) {
  return Spectrum::tabulated(columns.front(), columns[column], OutsideTable::Zero);
}

// Weights of the reflectance at whole nanometres, for reflectances linear in between: observer and
// lamp are linear there too, so that two Gauss points integrate the product exactly.
ReflectanceProjection projection_of(const Observer& observer, const Spectrum& d65) {
  const Development development = development_for(observer, d65);
  const double white_luminance = xyz_of(d65, observer).y;
  ReflectanceProjection projection;
  projection.weight_rec709.assign(kUpliftWavelengths, Vec3d(0.0));
  for (std::size_t i = 0; i < kUpliftWavelengths; ++i) {
    const double nm = kRangeMin_nm + static_cast<double>(i);
    projection.s.push_back((nm - 595.0) / 235.0);
    if (i + 1 == kUpliftWavelengths) break;
    for (const double fraction : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
      const double at_nm = nm + fraction;
      const Vec3d seen(observer.x_bar.value(at_nm), observer.y_bar.value(at_nm),
                       observer.z_bar.value(at_nm));
      const Vec3d weight =
          development.xyz_to_rec709 *
          (seen * (0.5 * kLuminousEfficacy_lm_per_W * d65.value(at_nm) / white_luminance));
      projection.weight_rec709[i] += (1.0 - fraction) * weight;
      projection.weight_rec709[i + 1] += fraction * weight;
    }
  }
  return projection;
}

// The nodes along the brightness axis of one hue and saturation, from the middle outwards, each
// fitted from its neighbour.
void fill_column(std::size_t largest, std::size_t j, std::size_t k,
                 const ReflectanceProjection& projection, std::vector<float>& table) {
  constexpr double kDarkest = 1e-5;  // black itself has no hue to keep
  const auto coordinate = [](std::size_t node) {
    return uplift_coordinate(static_cast<double>(node) / (kUpliftNodes - 1));
  };
  const auto color_at = [&](std::size_t i) {
    const double brightness = std::max(coordinate(i), kDarkest);
    Vec3d rgb_rec709;
    rgb_rec709[static_cast<int>(largest)] = brightness;
    rgb_rec709[static_cast<int>((largest + 1) % 3)] = brightness * coordinate(j);
    rgb_rec709[static_cast<int>((largest + 2) % 3)] = brightness * coordinate(k);
    return rgb_rec709;
  };
  const auto store = [&](std::size_t i, const NormalisedSigmoid& sigmoid) {
    for (std::size_t w = 0; w < 3; ++w) {
      const double s = kUpliftStored_s[w];
      const double x = (sigmoid.c[0] * s + sigmoid.c[1]) * s + sigmoid.c[2];
      table[uplift_index(largest, i, j, k) + w] = static_cast<float>(std::atan2(1.0, -x));
    }
  };
  const auto fit_from = [&](std::size_t i, const NormalisedSigmoid& neighbour) {
    const Vec3d color = color_at(i);
    if (color.r == color.g && color.g == color.b) return constant_reflectance(color.r);
    const NormalisedSigmoid near = fit_reflectance(color, projection, neighbour);
    // Where the neighbour was no good start, take the long way.
    const double miss = glm::length(projection.rec709(near) - color);
    return miss < 1e-4 * color[static_cast<int>(largest)] ? near
                                                          : fit_reflectance(color, projection);
  };
  const std::size_t middle = kUpliftNodes / 2;
  const NormalisedSigmoid first = fit_reflectance(color_at(middle), projection);
  store(middle, first);
  NormalisedSigmoid last = first;
  for (std::size_t i = middle + 1; i < kUpliftNodes; ++i) store(i, last = fit_from(i, last));
  last = first;
  for (std::size_t i = middle; i-- > 0;) store(i, last = fit_from(i, last));
}

void write(const std::string& file, const ReflectanceProjection& projection,
           const std::vector<float>& table) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (!out) throw std::runtime_error(file + ": cannot be written");
  std::fputs("#include \"color/uplift_table.h\"\n\nnamespace abbe {\n\n", out);
  std::fputs("extern const double kUpliftProjection[kUpliftWavelengths * 3] = {\n", out);
  for (const Vec3d& weight : projection.weight_rec709) {
    std::fprintf(out, "%.17g, %.17g, %.17g,\n", weight.r, weight.g, weight.b);
  }
  std::fputs("};\n\nextern const float kUpliftTable[kUpliftTableSize] = {\n", out);
  for (std::size_t i = 0; i < table.size(); ++i) {
    std::fprintf(out, "%.9e%s", double{table[i]}, i % 6 == 5 ? "f,\n" : "f,");
  }
  std::fputs("};\n\n}  // namespace abbe\n", out);
  if (std::fclose(out) != 0) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: " << argv[0] << " OBSERVER.txt D65.txt OUT.cpp\n";
    return 2;
  }
  try {
    const auto observer_columns = columns_of(argv[1], 4);
    const auto d65_columns = columns_of(argv[2], 2);
    const Observer observer{"observer/cie1931-2deg", curve(observer_columns, 1),
                            curve(observer_columns, 2), curve(observer_columns, 3)};
    const ReflectanceProjection projection = projection_of(observer, curve(d65_columns, 1));
    std::vector<float> table(kUpliftTableSize);
    parallel_for(0, 3 * kUpliftNodes * kUpliftNodes, 8, [&](std::size_t column) {
      fill_column(column / (kUpliftNodes * kUpliftNodes), column / kUpliftNodes % kUpliftNodes,
                  column % kUpliftNodes, projection, table);
    });
    write(argv[3], projection, table);
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return 1;
  }
  return 0;
}
