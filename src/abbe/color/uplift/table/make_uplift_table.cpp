// Makes the data of color/uplift.cpp from the measured observer and illuminant, as C++ source.
// Arguments: the observer's file, D65's file, those of Mallett and Yuksel's red, green and blue,
// the file to write.
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/base/parallel.h"
#include "abbe/color/color.h"
#include "abbe/color/uplift/fit.h"
#include "abbe/color/uplift/table.h"

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
  for (std::vector<double>& weights : projection.weight_rec709) weights.resize(kUpliftWavelengths);
  for (std::size_t i = 0; i < kUpliftWavelengths; ++i) {
    const double nm = kRangeMin_nm + static_cast<double>(i);
    projection.s.push_back((nm - 595.0) / 235.0);
    if (nm >= kRangeMax_nm) continue;
    for (const double fraction : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
      const double at_nm = nm + fraction;
      const Vec3d seen(observer.x_bar.value(at_nm), observer.y_bar.value(at_nm),
                       observer.z_bar.value(at_nm));
      const Vec3d weight =
          development.xyz_to_rec709 *
          (seen * (0.5 * kLuminousEfficacy_lm_per_W * d65.value(at_nm) / white_luminance));
      for (int channel = 0; channel < 3; ++channel) {
        std::vector<double>& weights = projection.weight_rec709[static_cast<std::size_t>(channel)];
        weights[i] += (1.0 - fraction) * weight[channel];
        weights[i + 1] += fraction * weight[channel];
      }
    }
  }
  return projection;
}

// The nodes along the brightness axis of one hue and saturation, from the middle outwards, each
// fitted from its neighbour.
void fill_column(std::size_t largest, std::size_t j, std::size_t k, const Mat3d& to_rec709,
                 const ReflectanceProjection& projection, std::vector<float>& table) {
  constexpr double kDarkest = 1e-5;  // black itself has no hue to keep
  const auto coordinate = [](std::size_t node) {
    return uplift_coordinate(static_cast<double>(node) / (kUpliftNodes - 1));
  };
  const bool is_grey = j == kUpliftNodes - 1 && k == kUpliftNodes - 1;
  const auto brightness_at = [&](std::size_t i) { return std::max(coordinate(i), kDarkest); };
  const auto color_at = [&](std::size_t i) {
    const double brightness = brightness_at(i);
    Vec3d of_space;
    of_space[static_cast<int>(largest)] = brightness;
    of_space[static_cast<int>((largest + 1) % 3)] = brightness * coordinate(j);
    of_space[static_cast<int>((largest + 2) % 3)] = brightness * coordinate(k);
    return is_grey ? Vec3d(brightness) : to_rec709 * of_space;
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
    return miss < 1e-4 * brightness_at(i) ? near : fit_reflectance(color, projection);
  };
  const std::size_t middle = kUpliftNodes / 2;
  const NormalisedSigmoid first = fit_reflectance(color_at(middle), projection);
  store(middle, first);
  NormalisedSigmoid last = first;
  bool is_impossible = false;
  for (std::size_t i = middle + 1; i < kUpliftNodes; ++i) {
    const Vec3d color = color_at(i);
    // What is too bright to exist stays so when it becomes brighter still.
    last = is_impossible ? nearest_optimal_color(color, projection) : fit_from(i, last);
    is_impossible =
        is_impossible || squared_miss_in_lab(last, color, projection) > kMissedInLab * kMissedInLab;
    store(i, last);
  }
  last = first;
  for (std::size_t i = middle; i-- > 0;) store(i, last = fit_from(i, last));
}

using Triples = std::array<std::vector<double>, 3>;

void write_triples(std::FILE* out, const char* name, const char* rows, const Triples& columns) {
  std::fprintf(out, "extern const double %s[%s * 3] = {\n", name, rows);
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    std::fprintf(out, "%.17g, %.17g, %.17g,\n", columns[0][i], columns[1][i], columns[2][i]);
  }
  std::fputs("};\n\n", out);
}

Triples mallett_yuksel_basis(char** files) {
  Triples basis;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto columns = columns_of(files[i], 2);
    if (columns[0].size() != kMallettYukselRows || columns[0].front() != kMallettYukselFirst_nm ||
        columns[0][1] - columns[0][0] != kMallettYukselStep_nm) {
      throw std::runtime_error(std::string(files[i]) + ": other wavelengths than uplift_table.h");
    }
    basis[i] = columns[1];
  }
  return basis;
}

void write(const std::string& file, const ReflectanceProjection& projection, const Triples& basis,
           const std::vector<std::vector<float>>& tables) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (!out) throw std::runtime_error(file + ": cannot be written");
  std::fputs("#include \"abbe/color/uplift/table.h\"\n\nnamespace abbe {\n\n", out);
  write_triples(out, "kUpliftProjection", "kUpliftWavelengths", projection.weight_rec709);
  write_triples(out, "kMallettYukselBasis", "kMallettYukselRows", basis);
  std::fputs("extern const float kUpliftTables[kUpliftSpaces.size()][kUpliftTableSize] = {\n", out);
  for (const std::vector<float>& table : tables) {
    std::fputs("{", out);
    for (std::size_t i = 0; i < table.size(); ++i) {
      std::fprintf(out, "%.9e%s", double{table[i]}, i % 6 == 5 ? "f,\n" : "f,");
    }
    std::fputs("},\n", out);
  }
  std::fputs("};\n\n}  // namespace abbe\n", out);
  if (std::fclose(out) != 0) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    std::cerr << "usage: " << argv[0]
              << " OBSERVER.txt D65.txt RED.txt GREEN.txt BLUE.txt OUT.cpp\n";
    return 2;
  }
  try {
    const auto observer_columns = columns_of(argv[1], 4);
    const auto d65_columns = columns_of(argv[2], 2);
    const Observer observer{"observer/cie1931-2deg", curve(observer_columns, 1),
                            curve(observer_columns, 2), curve(observer_columns, 3)};
    const ReflectanceProjection projection = projection_of(observer, curve(d65_columns, 1));
    std::vector<std::vector<float>> tables;
    for (const RgbSpace space : kUpliftSpaces) {
      const Mat3d to_rec709 = rgb_to_rec709(space);
      std::vector<float>& table = tables.emplace_back(kUpliftTableSize);
      parallel_for(0, 3 * kUpliftNodes * kUpliftNodes, 8, [&](std::size_t column) {
        fill_column(column / (kUpliftNodes * kUpliftNodes), column / kUpliftNodes % kUpliftNodes,
                    column % kUpliftNodes, to_rec709, projection, table);
      });
    }
    write(argv[6], projection, mallett_yuksel_basis(argv + 3), tables);
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return 1;
  }
  return 0;
}
