/// `abbe spectra`: the catalogue of measured spectra.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/describe/describe.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/console.h"
#include "abbe/cli/print/text.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/load/spectra/computed.h"
#include "abbe/report/figures/spectra.h"

namespace abbe {
namespace {

struct SpectraArguments {
  std::string text, kind, n_d, V_d;  // list
  std::string id, at, lamp;          // show
  std::vector<std::string> names;    // plot
  std::string output, diagram = "curves", range;
  bool as_json = false;
};

using Interval = std::pair<double, double>;

// `A:B`, or one end left open: `1.7:`.
Interval interval_of(const std::string& option, const std::string& text) {
  Interval interval{-kInfinity, kInfinity};
  if (text.empty()) return interval;
  const std::size_t colon = text.find(':');
  const std::string low = text.substr(0, colon);
  const std::string high = colon == std::string::npos ? "" : text.substr(colon + 1);
  const auto from = number_of(low), to = number_of(high);
  if (colon == std::string::npos || (low.empty() && high.empty()) || (!low.empty() && !from) ||
      (!high.empty() && !to) || (from && to && *from > *to)) {
    throw_usage_error(option, "\"" + text + "\"", "A:B, as in 1.5:1.6 or 1.7:");
  }
  if (from) interval.first = *from;
  if (to) interval.second = *to;
  return interval;
}

bool contains(const Interval& interval, double value) {
  return value >= interval.first && value <= interval.second;
}

// What cannot be read is said and left out: one file must not hide all others.
Catalogue opened_catalogue() {
  Catalogue catalogue = Catalogue::standard();
  Console(false).show(catalogue.notes());
  return catalogue;
}

std::vector<CatalogueEntry> readable_entries(const Catalogue& catalogue) {
  std::vector<CatalogueEntry> entries;
  Notes notes;
  for (const std::string& id : catalogue.ids()) {
    try {
      entries.push_back(catalogue.entry(id, id));
    } catch (const Error& unreadable) {
      notes.warn("", std::string(unreadable.what()) + "; the spectrum is left out");
    }
  }
  Console(false).show(notes);
  return entries;
}

// An id, a unique end of one, or a file.
CatalogueEntry named_entry(const Catalogue& catalogue, const std::string& name,
                           const std::string& where) {
  const std::size_t hash = std::min(name.find('#'), name.size());
  const std::filesystem::path file = name.substr(0, hash);
  std::error_code ignored;
  if (!is_spectrum_path(name) && !std::filesystem::exists(file, ignored)) {
    return catalogue.entry(name, where);
  }
  return read_spectrum_file(file, name, hash < name.size() ? name.substr(hash + 1) : "");
}

ExitCode run_list(const SpectraArguments& arguments) {
  const Interval n_d_range = interval_of("--nd", arguments.n_d);
  const Interval V_d_range = interval_of("--vd", arguments.V_d);
  const bool wants_dispersion = !arguments.n_d.empty() || !arguments.V_d.empty();
  const std::string wanted = lower_case(arguments.text);
  const Catalogue catalogue = opened_catalogue();
  Description list = Description::array();
  std::string text;
  std::set<std::string> kinds;
  for (const CatalogueEntry& entry : readable_entries(catalogue)) {
    const std::string& id = entry.id;
    const std::string kind = kind_of(entry);
    kinds.insert({kind, entry.quantity});
    if (!arguments.kind.empty() && arguments.kind != kind && arguments.kind != entry.quantity) {
      continue;
    }
    if (lower_case(id + "\n" + entry.name).find(wanted) == std::string::npos) continue;
    if (wants_dispersion && !entry.dispersion) continue;
    Description item;
    item["id"] = id;
    item["kind"] = kind;
    item["quantity"] = entry.quantity;
    item["name"] = entry.name;
    item["range_nm"] = {entry.range_min_nm, entry.range_max_nm};
    if (entry.is_default) item["default"] = true;
    std::string line = fmt::format("{:<36} {:<14}", id, entry.quantity);
    if (entry.dispersion) {
      const double n_d = refractive_index(*entry.dispersion, kLine_d_nm);
      const double V_d = abbe_number(*entry.dispersion);
      if (!contains(n_d_range, n_d) || !contains(V_d_range, V_d)) continue;
      item["n_d"] = n_d;
      item["V_d"] = V_d;
      line += fmt::format(" n_d {:.5f}  V_d {:.2f}", n_d, V_d);
    } else {
      line += " " + printable(entry.name);
    }
    if (entry.is_default) line += "  (default)";
    text += line + "\n";
    list.push_back(std::move(item));
  }
  if (!arguments.kind.empty()) {
    check_choice("--kind", arguments.kind, "a folder of the catalogue or a quantity",
                 {kinds.begin(), kinds.end()});
  }
  print(arguments.as_json ? json_text(list) : text);
  return ExitCode::Done;
}

std::vector<double> wavelengths_of(const std::string& text) {
  std::vector<double> wavelengths_nm;
  if (text.empty()) return wavelengths_nm;
  for (const std::string& part : split(text, ',')) {
    const auto number = number_of(part);
    if (!number || *number < kRangeMin_nm || *number > kRangeMax_nm) {
      throw_usage_error("--at", "\"" + part + "\"",
                        fmt::format("wavelengths from {} to {} nm, as in 486.13,587.56",
                                    kRangeMin_nm, kRangeMax_nm));
    }
    wavelengths_nm.push_back(*number);
  }
  return wavelengths_nm;
}

ExitCode run_show(const SpectraArguments& arguments) {
  const std::vector<double> at_nm = wavelengths_of(arguments.at);
  const Catalogue catalogue = opened_catalogue();
  const CatalogueEntry lamp = named_entry(catalogue, arguments.lamp, "--lamp");
  if (lamp.quantity != "emission") {
    throw_usage_error("--lamp", fmt::format("{} ({})", lamp.id, lamp.quantity), "a lamp");
  }
  SpectrumView view{catalogue.observer(),           lamp.id, *lamp.spectrum, at_nm,
                    daylight_components(catalogue), {}};
  for (std::size_t i = 0; i < view.test_colors.size(); ++i) {
    const std::string id = fmt::format("reflectance/cri/TCS{:02}", i + 1);
    view.test_colors[i] = catalogue.entry(id, id).spectrum.value();
  }
  const Description description =
      describe_spectrum(named_entry(catalogue, arguments.id, "abbe spectra show"), view);
  print(arguments.as_json ? json_text(description) : plain_text(description));
  return ExitCode::Done;
}

// Without names: all that the diagram is made for.
std::vector<CatalogueEntry> entries_to_plot(const SpectraArguments& arguments,
                                            const Catalogue& catalogue) {
  std::vector<CatalogueEntry> entries;
  for (const std::string& name : arguments.names) {
    entries.push_back(named_entry(catalogue, name, "abbe spectra plot"));
  }
  if (!entries.empty()) return entries;
  if (arguments.diagram == "curves") {
    throw_usage_error("NAME", "none", "what to plot, as in N-BK7 N-SF11");
  }
  static const std::vector<std::string> lamps{"A",   "C",   "D50",  "D65",
                                              "FL2", "FL7", "FL11", "LED-B3"};
  if (arguments.diagram == "chromaticity") {
    for (const std::string& lamp : lamps) {
      entries.push_back(catalogue.entry("illuminant/" + lamp, "abbe spectra plot"));
    }
    return entries;
  }
  for (CatalogueEntry& entry : readable_entries(catalogue)) {
    if (entry.dispersion && std::isfinite(abbe_number(*entry.dispersion))) {
      entries.push_back(std::move(entry));
    }
  }
  return entries;
}

ExitCode run_plot(const SpectraArguments& arguments) {
  check_choice("--diagram", arguments.diagram, "a kind of diagram",
               {"curves", "glass-map", "chromaticity"});
  Interval range_nm{kRangeMin_nm, kRangeMax_nm};
  if (!arguments.range.empty()) range_nm = parse_range(arguments.range);
  if (!(range_nm.first >= kRangeMin_nm && range_nm.second <= kRangeMax_nm &&
        range_nm.second - range_nm.first >= 1.0)) {
    throw_usage_error("--range", "\"" + arguments.range + "\"",
                      fmt::format("a rising range within {}:{}", kRangeMin_nm, kRangeMax_nm));
  }
  const std::filesystem::path file = arguments.output;
  if (!arguments.output.empty() && file.extension() != ".svg") {
    throw_usage_error("-o", "\"" + arguments.output + "\"", "a file that ends in .svg");
  }
  if (!arguments.output.empty()) check_writable(file);
  const Catalogue catalogue = opened_catalogue();
  const std::vector<CatalogueEntry> entries = entries_to_plot(arguments, catalogue);
  const std::string svg = arguments.diagram == "glass-map" ? plot_glass_map(entries)
                          : arguments.diagram == "chromaticity"
                              ? plot_chromaticity(entries, catalogue.observer())
                              : plot_curves(entries, range_nm, catalogue.observer());
  if (arguments.output.empty()) {
    print(svg);
  } else {
    write_text(file, svg);
  }
  return ExitCode::Done;
}

}  // namespace

void add_spectra_command(CLI::App& program, ExitCode& code) {
  CLI::App& command =
      *program.add_subcommand("spectra", "List, show and plot the measured spectra");
  command.require_subcommand(1);
  const auto arguments = std::make_shared<SpectraArguments>();
  CLI::App& list = *command.add_subcommand("list", "All ids, with n_d and V_d of glasses");
  list.add_option("TEXT", arguments->text, "only those with this in their id or name");
  add_shown(list, "--kind", arguments->kind, "KIND",
            "only a folder of the catalogue (glass, metal, ...) or a quantity (emission, ...)");
  add_shown(list, "--nd", arguments->n_d, "A:B", "only with n_d in this range, as in 1.7:1.8");
  add_shown(list, "--vd", arguments->V_d, "A:B", "only with V_d in this range, as in :30");
  list.add_flag("--json", arguments->as_json, "print JSON");
  list.callback([arguments, &code] { code = run_list(*arguments); });

  CLI::App& show = *command.add_subcommand("show", "One spectrum: its source, range and numbers");
  show.add_option("ID", arguments->id, "id or the unique end of one, as in N-SF11")->required();
  add_shown(show, "--at", arguments->at, "A,B,C", "also the values at these wavelengths in nm");
  arguments->lamp = "illuminant/D65";
  add_shown(show, "--lamp", arguments->lamp, "ID",
            "lamp under which a reflectance has its colour (default: illuminant/D65)");
  show.add_flag("--json", arguments->as_json, "print JSON");
  show.callback([arguments, &code] { code = run_show(*arguments); });

  CLI::App& plot = *command.add_subcommand("plot", "A diagram of spectra as SVG");
  plot.add_option("NAME", arguments->names, "ids or unique ends of them");
  add_shown(plot, "-o,--output", arguments->output, "FILE.svg", "file to write (default: stdout)");
  add_shown(plot, "--diagram", arguments->diagram, "NAME",
            "curves, glass-map (n_d against V_d) or chromaticity (default: curves)");
  add_shown(plot, "--range", arguments->range, "A:B",
            "wavelengths of the curves (default: 360:830)");
  plot.callback([arguments, &code] { code = run_plot(*arguments); });
}

}  // namespace abbe
