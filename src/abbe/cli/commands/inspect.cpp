/// `abbe inspect`: what was understood of a scene or an image, and what was not.

#include <algorithm>
#include <memory>

#include "abbe/base/text.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/describe/describe.h"
#include "abbe/cli/options/outputs.h"
#include "abbe/cli/options/scene.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/text.h"
#include "abbe/session/prepare.h"

namespace abbe {
namespace {

struct InspectArguments {
  SceneChoice choice;
  std::string rig = "auto", emissive_light = "auto";
  bool as_json = false;
};

bool is_image(const std::filesystem::path& file) {
  const std::string suffix = lower_case(file.extension().string());
  return std::find(image_suffixes().begin(), image_suffixes().end(), suffix) !=
         image_suffixes().end();
}

// A list of channels as one line: spectral ones would fill the screen.
void shorten_channels(Description& image) {
  if (!image.contains("spectral_channels_nm")) return;
  const Description spectral_nm = image["spectral_channels_nm"];
  Description others = Description::array();
  for (const Description& channel : image["channels"]) {
    const std::string name = channel["name"];
    if (!name.starts_with("S0.")) others.push_back(channel);
  }
  image["channels"] = std::move(others);
  image["spectral_channels_nm"] = std::to_string(spectral_nm.size()) + ", " +
                                  spectral_nm.front().dump() + " to " + spectral_nm.back().dump();
}

void shorten_notes(Description& scene) {
  constexpr std::size_t kMaxPlaces = 4;
  for (Description& note : scene["notes"]) {
    Description& places = note["where"];
    const std::size_t count = places.size();
    if (count <= kMaxPlaces) continue;
    places.erase(places.begin() + kMaxPlaces, places.end());
    places.push_back("and " + std::to_string(count - kMaxPlaces) + " more");
  }
}

ExitCode run_inspect(InspectArguments& arguments) {
  arguments.choice.rig = rig_from_name(arguments.rig);
  arguments.choice.emissive_light = emissive_light_from_name(arguments.emissive_light);
  Description description;
  if (is_image(arguments.choice.file)) {
    description = describe_image(arguments.choice.file);
    if (!arguments.as_json) shorten_channels(description);
  } else {
    Notes notes;
    const Catalogue catalogue = Catalogue::standard();
    const PreparedScene prepared = prepare_scene(arguments.choice, catalogue, notes);
    description = describe_scene(prepared, notes);
    if (!arguments.as_json) shorten_notes(description);
  }
  print(arguments.as_json ? json_text(description) : plain_text(description));
  return ExitCode::Done;
}

}  // namespace

void add_inspect_command(CLI::App& program, ExitCode& code) {
  CLI::App& command = *program.add_subcommand(
      "inspect", "Say what was understood of a scene or an image, and what was ignored");
  const auto arguments = std::make_shared<InspectArguments>();
  command
      .add_option("FILE", arguments->choice.file, "scene (.gltf, .glb) or image (.exr, .png, ...)")
      ->required();
  add_shown(command, "--scene", arguments->choice.scene, "NAME",
            "scene of the file to take, by name or by number from 0 (default: the file's own)");
  add_shown(command, "--camera", arguments->choice.camera, "NAME",
            "camera to mark as chosen; frame: one that frames the scene (default: the first)");
  add_light_options(command, arguments->choice, arguments->rig, arguments->emissive_light);
  add_reading_options(command, arguments->choice);
  command.add_flag("--json", arguments->as_json, "print JSON");
  command.callback([arguments, &code] { code = run_inspect(*arguments); });
}

}  // namespace abbe
