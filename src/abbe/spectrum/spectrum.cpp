#include "abbe/spectrum/spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

struct Table {
  std::vector<double> wavelength_nm;
  std::vector<double> values;
  OutsideTable outside = OutsideTable::Zero;
};

struct Blackbody {
  double temperature_K = 0.0;
};

double value_of(double constant, double) {
  return constant;
}

double value_of(const std::shared_ptr<const Table>& table, double wavelength_nm) {
  const std::vector<double>& x = table->wavelength_nm;
  const std::vector<double>& y = table->values;
  if (wavelength_nm < x.front() || wavelength_nm > x.back()) {
    if (table->outside == OutsideTable::Zero) return 0.0;
    return wavelength_nm < x.front() ? y.front() : y.back();
  }
  const auto above = std::upper_bound(x.begin(), x.end(), wavelength_nm);
  if (above == x.end()) return y.back();
  const auto i = static_cast<std::size_t>(above - x.begin());
  const double t = (wavelength_nm - x[i - 1]) / (x[i] - x[i - 1]);
  return y[i - 1] + t * (y[i] - y[i - 1]);
}

double value_of(const Blackbody& blackbody, double wavelength_nm) {
  // CODATA 2018, exact: c1L = 2hc² in W·m²·sr⁻¹, c2 = hc/k in m·K.
  constexpr double kPlanck_Js = 6.62607015e-34;
  constexpr double kLightSpeed_m_per_s = 299792458.0;
  constexpr double kBoltzmann_J_per_K = 1.380649e-23;
  constexpr double c1 = 2.0 * kPlanck_Js * kLightSpeed_m_per_s * kLightSpeed_m_per_s;
  constexpr double c2 = kPlanck_Js * kLightSpeed_m_per_s / kBoltzmann_J_per_K;
  const double wavelength_m = wavelength_nm * 1e-9;
  const double per_m =
      c1 / std::pow(wavelength_m, 5) / std::expm1(c2 / (wavelength_m * blackbody.temperature_K));
  return per_m * 1e-9;
}

double value_of(const SigmoidPolynomial& p, double wavelength_nm) {
  const double x = (p.c0 * wavelength_nm + p.c1) * wavelength_nm + p.c2;
  return 0.5 + 0.5 * x / std::sqrt(1.0 + x * x);
}

// The wavelengths between which a spectrum is smooth: the whole nanometres of the range and the
// points of the tables.
std::vector<double> knots(std::span<const double> a, std::span<const double> b) {
  std::vector<double> result;
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 1.0) result.push_back(nm);
  for (const std::span<const double> points : {a, b}) {
    for (const double nm : points) {
      if (nm > kRangeMin_nm && nm < kRangeMax_nm) result.push_back(nm);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

bool in_range(double wavelength_nm) {
  return wavelength_nm >= kRangeMin_nm && wavelength_nm <= kRangeMax_nm;
}

}  // namespace

struct Spectrum::Data {
  std::variant<double, std::shared_ptr<const Table>, Blackbody, SigmoidPolynomial> continuous = 0.0;
  double factor = 1.0;
  std::vector<SpectralLine> lines;

  std::span<const double> table_points() const {
    const auto* table = std::get_if<std::shared_ptr<const Table>>(&continuous);
    return table ? std::span<const double>((*table)->wavelength_nm) : std::span<const double>();
  }
};

Spectrum Spectrum::constant(double value) {
  Spectrum result;
  result.data_ = std::make_shared<Data>(Data{value, 1.0, {}});
  return result;
}

Spectrum Spectrum::tabulated(std::vector<double> wavelength_nm, std::vector<double> values,
                             OutsideTable outside) {
  if (wavelength_nm.empty() || wavelength_nm.size() != values.size()) {
    throw_input_error(
        "", fmt::format("{} wavelengths and {} values", wavelength_nm.size(), values.size()),
        "as many values as wavelengths, and at least one");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(wavelength_nm[i]) || !std::isfinite(values[i])) {
      throw_input_error(fmt::format("row {}", i + 1),
                        fmt::format("{} nm, value {}", wavelength_nm[i], values[i]),
                        "finite numbers");
    }
    if (i > 0 && wavelength_nm[i] <= wavelength_nm[i - 1]) {
      throw_input_error(fmt::format("row {}", i + 1),
                        fmt::format("{} nm after {} nm", wavelength_nm[i], wavelength_nm[i - 1]),
                        "rising wavelengths");
    }
  }
  Spectrum result;
  result.data_ = std::make_shared<Data>(Data{
      std::make_shared<const Table>(Table{std::move(wavelength_nm), std::move(values), outside}),
      1.0,
      {}});
  return result;
}

Spectrum Spectrum::blackbody(double temperature_K) {
  if (!(temperature_K > 0.0) || !std::isfinite(temperature_K)) {
    throw_input_error("", fmt::format("a blackbody of {} K", temperature_K),
                      "a temperature above 0 K");
  }
  Spectrum result;
  result.data_ = std::make_shared<Data>(Data{Blackbody{temperature_K}, 1.0, {}});
  return result;
}

Spectrum Spectrum::sigmoid(const SigmoidPolynomial& polynomial) {
  Spectrum result;
  result.data_ = std::make_shared<Data>(Data{polynomial, 1.0, {}});
  return result;
}

Spectrum Spectrum::lines(std::vector<SpectralLine> lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!std::isfinite(lines[i].wavelength_nm) || !std::isfinite(lines[i].strength)) {
      throw_input_error(
          fmt::format("line {}", i + 1),
          fmt::format("{} nm, strength {}", lines[i].wavelength_nm, lines[i].strength),
          "finite numbers");
    }
  }
  std::stable_sort(lines.begin(), lines.end(), [](const SpectralLine& a, const SpectralLine& b) {
    return a.wavelength_nm < b.wavelength_nm;
  });
  Spectrum result;
  result.data_ = std::make_shared<Data>(Data{0.0, 1.0, std::move(lines)});
  return result;
}

double Spectrum::value(double wavelength_nm) const {
  if (!data_) return 0.0;
  return data_->factor * std::visit([&](const auto& part) { return value_of(part, wavelength_nm); },
                                    data_->continuous);
}

std::span<const SpectralLine> Spectrum::lines() const {
  return data_ ? std::span<const SpectralLine>(data_->lines) : std::span<const SpectralLine>();
}

std::span<const double> Spectrum::table_points_nm() const {
  return data_ ? data_->table_points() : std::span<const double>();
}

bool Spectrum::is_lines_only() const {
  if (!data_ || data_->factor == 0.0) return true;
  if (const double* constant = std::get_if<double>(&data_->continuous)) return *constant == 0.0;
  if (const auto* table = std::get_if<std::shared_ptr<const Table>>(&data_->continuous)) {
    return std::all_of((*table)->values.begin(), (*table)->values.end(),
                       [](double value) { return value == 0.0; });
  }
  return false;
}

Spectrum Spectrum::scaled(double factor) const {
  if (!data_) return {};
  Data scaled_data = *data_;
  scaled_data.factor *= factor;
  for (SpectralLine& line : scaled_data.lines) line.strength *= factor;
  Spectrum result;
  result.data_ = std::make_shared<const Data>(std::move(scaled_data));
  return result;
}

Spectrum product(const Spectrum& a, const Spectrum& b) {
  Spectrum result;
  if (!a.data_ || !b.data_) return result;
  auto data = std::make_shared<Spectrum::Data>();
  if (!a.is_lines_only() && !b.is_lines_only()) {
    Table table;
    table.outside = OutsideTable::Clamp;
    table.wavelength_nm = knots(a.table_points_nm(), b.table_points_nm());
    // Where a factor ends with a jump to zero, so does the product.
    for (const Spectrum* factor : {&a, &b}) {
      const auto* part = std::get_if<std::shared_ptr<const Table>>(&factor->data_->continuous);
      if (!part || (*part)->outside != OutsideTable::Zero) continue;
      table.outside = OutsideTable::Zero;
      std::erase_if(table.wavelength_nm, [&](double nm) {
        return nm < (*part)->wavelength_nm.front() || nm > (*part)->wavelength_nm.back();
      });
    }
    for (const double nm : table.wavelength_nm) table.values.push_back(a.value(nm) * b.value(nm));
    if (!table.values.empty()) data->continuous = std::make_shared<const Table>(std::move(table));
  }
  for (const auto& [lines_of, continuous] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    for (const SpectralLine& line : lines_of->lines()) {
      data->lines.push_back(
          {line.wavelength_nm, line.strength * continuous->value(line.wavelength_nm)});
    }
  }
  std::stable_sort(data->lines.begin(), data->lines.end(),
                   [](const SpectralLine& first, const SpectralLine& second) {
                     return first.wavelength_nm < second.wavelength_nm;
                   });
  result.data_ = std::move(data);
  return result;
}

double integral(const Spectrum& spectrum) {
  return integral(spectrum, Spectrum::constant(1.0));
}

double integral(const Spectrum& spectrum, const Spectrum& weight) {
  double sum = 0.0;
  if (!spectrum.is_lines_only() && !weight.is_lines_only()) {
    const std::vector<double> points = knots(spectrum.table_points_nm(), weight.table_points_nm());
    // The two points of Gauss and Legendre: exact for cubics, and never on the edge of a table,
    // where a lamp may end with a jump.
    const double offset = 0.5 / std::sqrt(3.0);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double width = points[i] - points[i - 1];
      const double middle = 0.5 * (points[i] + points[i - 1]);
      const double low = middle - offset * width;
      const double high = middle + offset * width;
      sum += 0.5 * width *
             (spectrum.value(low) * weight.value(low) + spectrum.value(high) * weight.value(high));
    }
  }
  for (const SpectralLine& line : spectrum.lines()) {
    if (in_range(line.wavelength_nm)) sum += line.strength * weight.value(line.wavelength_nm);
  }
  for (const SpectralLine& line : weight.lines()) {
    if (in_range(line.wavelength_nm)) sum += line.strength * spectrum.value(line.wavelength_nm);
  }
  return sum;
}

}  // namespace abbe
