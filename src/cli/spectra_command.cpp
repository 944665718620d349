/// `abbe spectra`: the catalogue of measured spectra.

#include <fmt/format.h>

#include <memory>

#include "base/constants.h"
#include "cli/commands.h"
#include "cli/describe.h"
#include "cli/print.h"
#include "load/catalogue.h"

namespace abbe {
namespace {

struct SpectraArguments {
  std::string id;
  bool as_json = false;
};

ExitCode run_list(const SpectraArguments& arguments) {
  const Catalogue catalogue = Catalogue::standard();
  Description list = Description::array();
  std::string text;
  for (const std::string& id : catalogue.ids()) {
    const CatalogueEntry entry = catalogue.entry(id, id);
    Description item;
    item["id"] = id;
    item["quantity"] = entry.quantity;
    item["name"] = entry.name;
    text += fmt::format("{:<36} {:<14}", id, entry.quantity);
    if (entry.dispersion) {
      const double n_d = refractive_index(*entry.dispersion, kLine_d_nm);
      const double V_d = abbe_number(*entry.dispersion);
      item["n_d"] = n_d;
      item["V_d"] = V_d;
      text += fmt::format(" n_d {:.5f}  V_d {:.2f}", n_d, V_d);
    } else {
      text += " " + printable(entry.name);
    }
    text += "\n";
    list.push_back(std::move(item));
  }
  print(arguments.as_json ? json_text(list) : text);
  return ExitCode::Done;
}

ExitCode run_show(const SpectraArguments& arguments) {
  const Catalogue catalogue = Catalogue::standard();
  const Description description =
      describe_spectrum(catalogue.entry(arguments.id, "abbe spectra show"));
  print(arguments.as_json ? json_text(description) : plain_text(description));
  return ExitCode::Done;
}

}  // namespace

void add_spectra_command(CLI::App& program, ExitCode& code) {
  CLI::App& command = *program.add_subcommand("spectra", "List and show the measured spectra");
  command.require_subcommand(1);
  const auto arguments = std::make_shared<SpectraArguments>();
  CLI::App& list = *command.add_subcommand("list", "All ids, with n_d and V_d of glasses");
  list.add_flag("--json", arguments->as_json, "print JSON");
  list.callback([arguments, &code] { code = run_list(*arguments); });
  CLI::App& show = *command.add_subcommand("show", "One spectrum: its source, range and numbers");
  show.add_option("ID", arguments->id, "id or the unique end of one, as in N-SF11")->required();
  show.add_flag("--json", arguments->as_json, "print JSON");
  show.callback([arguments, &code] { code = run_show(*arguments); });
}

}  // namespace abbe
