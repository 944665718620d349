#include "abbe/load/spectra/observer_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/color/development.h"
#include "abbe/load/spectra/text.h"

namespace abbe {
namespace {

constexpr std::uint64_t kLargestFile = 4u << 20;
constexpr std::size_t kMaxRows = 100'000;

std::vector<std::string_view> fields_of(std::string_view line) {
  constexpr std::string_view kBlank = " \t\"";
  constexpr std::string_view kEnd = ",;";
  const std::string_view separators =
      line.find_first_of(kEnd) == std::string_view::npos ? std::string_view(" \t") : kEnd;
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = std::min(line.find_first_of(separators), line.size());
    std::string_view field = line.substr(0, end);
    const std::size_t first = field.find_first_not_of(kBlank);
    field = first == std::string_view::npos ? "" : field.substr(first);
    while (!field.empty() && kBlank.find(field.back()) != std::string_view::npos) {
      field.remove_suffix(1);
    }
    // A run of blanks is one separator; between two commas nothing stands.
    if (separators == kEnd || !field.empty()) fields.push_back(field);
    if (end == line.size()) return fields;
    line.remove_prefix(end + 1);
  }
}

bool names_matching_functions(const std::vector<std::string_view>& fields) {
  constexpr std::array<std::string_view, 3> kLower{"x", "y", "z"}, kUpper{"X", "Y", "Z"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!fields[i + 1].starts_with(kLower[i]) && !fields[i + 1].starts_with(kUpper[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace

Observer read_observer_csv(const std::filesystem::path& file, const Observer& photometer,
                           const Spectrum& d65) {
  const std::vector<std::uint8_t> bytes = read_file(file, file.string(), kLargestFile);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);

  std::size_t number = 0;
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw_input_error(fmt::format("{}:{}", file.string(), std::max<std::size_t>(number, 1)), found,
                      expected);
  };
  bool are_matching_functions = false;
  std::vector<double> nm;
  std::array<std::vector<double>, 3> values;
  bool is_first = true;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    const std::vector<std::string_view> fields = fields_of(line);
    if (line.starts_with('#') || fields.empty() || (fields.size() == 1 && fields[0].empty())) {
      continue;
    }
    if (fields.size() != 4) {
      fail(fmt::format("{} columns", fields.size()), "4: a wavelength and three sensitivities");
    }
    if (std::exchange(is_first, false) && !number_of(fields[0])) {
      are_matching_functions = names_matching_functions(fields);
      continue;
    }
    std::array<double, 4> row{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto value = number_of(fields[i]);
      if (!value) fail("\"" + std::string(fields[i]) + "\"", "a finite number");
      row[i] = *value;
    }
    if (!(row[0] >= 1.0 && row[0] <= 1e5)) {
      fail(fmt::format("a wavelength of {}", row[0]), "one in nm, 1 to 100000");
    }
    if (!nm.empty() && row[0] <= nm.back()) {
      fail(fmt::format("{} nm after {} nm", row[0], nm.back()), "rising wavelengths");
    }
    if (nm.size() == kMaxRows) fail("another row", fmt::format("at most {}", kMaxRows));
    nm.push_back(row[0]);
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(row[c + 1]);
  }
  if (nm.size() < 2) fail(fmt::format("{} rows", nm.size()), "at least two wavelengths");

  const auto curve = [&](std::size_t c) {
    return Spectrum::tabulated(nm, values[c], OutsideTable::Zero);
  };
  Observer observer{fmt::format("csv:{:016x}", hash_bytes(bytes.data(), bytes.size())), curve(0),
                    curve(1), curve(2)};
  number = 0;
  if (are_matching_functions) {
    const Vec3d white = responses_of(d65, observer);
    if (!(white.x > 0.0 && white.y > 0.0 && white.z > 0.0)) {
      fail("matching functions that D65 is not positive for", "three that see daylight");
    }
    return observer;
  }
  observer.id = file.string();  // For its message.
  const SensorFit fit = fit_sensor(observer, photometer, d65);
  observer.id = fmt::format("csv:{:016x}, camera, mean CIEDE2000 {:.2f} of 125 colours",
                            hash_bytes(bytes.data(), bytes.size()), fit.mean_delta_e2000);
  observer.responses_to_xyz = fit.responses_to_xyz;
  return observer;
}

bool is_observer_file(const std::string& name) {
  if (name == "cie1931" || name == "cie1964") return false;
  std::error_code ignored;
  return name.ends_with(".csv") || std::filesystem::exists(name, ignored);
}

Observer observer_named(const std::string& name, const Catalogue& catalogue,
                        const Observer& photometer, const Spectrum& d65) {
  if (is_observer_file(name)) return read_observer_csv(name, photometer, d65);
  if (name == "cie1931") return catalogue.observer("observer/cie1931-2deg");
  if (name == "cie1964") return catalogue.observer("observer/cie1964-10deg");
  std::vector<std::string> choices{"cie1931", "cie1964"};
  for (const std::string& id : catalogue.ids()) {
    if (!id.starts_with("observer/")) continue;
    if (id == name || id.ends_with("/" + name)) return catalogue.observer(id);
    choices.push_back(id);
  }
  choices.emplace_back("FILE.csv");
  throw_usage_error("observer", "\"" + name + "\"", "an observer", choices);
}

}  // namespace abbe
