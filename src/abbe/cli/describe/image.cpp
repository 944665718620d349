
#include <variant>

#include "abbe/base/error.h"
#include "abbe/cli/describe/describe.h"
#include "abbe/cli/print/render_command.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"

namespace abbe {
namespace {

Description describe_exr(const std::filesystem::path& file) {
  const ExrHeader header = read_exr_header(file);
  Description out;
  out["format"] = "EXR";
  out["size"] = {header.width, header.height};
  if (header.full_size != Vec2i(0)) {
    out["crop"] = {header.data_origin.x, header.data_origin.y, header.data_origin.x + header.width,
                   header.data_origin.y + header.height};
    out["full_size"] = {header.full_size.x, header.full_size.y};
  }
  out["compression"] = header.compression;
  if (header.tile_size > 0) out["tiles"] = header.tile_size;
  if (header.part_count > 1) out["parts"] = header.part_count;
  if (header.chromaticities) {
    const auto& xy = *header.chromaticities;
    for (const float value : xy) out["chromaticities"].push_back(short_decimal(value));
  }
  out["channels"] = Description::array();
  Description spectral_nm = Description::array();
  for (const ExrHeader::Channel& channel : header.channels) {
    if (const auto wavelength_nm = spectral_channel_wavelength_nm(channel.name)) {
      spectral_nm.push_back(*wavelength_nm);
    }
    Description entry;
    entry["name"] = channel.name;
    entry["type"] = channel.type;
    out["channels"].push_back(std::move(entry));
  }
  if (!spectral_nm.empty()) out["spectral_channels_nm"] = std::move(spectral_nm);
  for (const IdNames& ids : header.id_names) {
    Description& names = out["id_names"][ids.channel];
    for (const auto& [id, name] : ids.names) names[std::to_string(id)] = name;
  }
  out["attributes"] = Description::object();
  for (const auto& [name, value] : header.attributes) {
    std::visit([&out, &key = name](const auto& typed) { out["attributes"][key] = typed; }, value);
  }
  try {
    if (const auto recipe = recipe_of(header)) out["command"] = render_command(*recipe);
  } catch (const Error& error) {
    // A file of another version is still one to look at.
    out["note"] = std::string("no command: ") + error.what();
  }
  return out;
}

}  // namespace

Description describe_image(const std::filesystem::path& file) {
  if (file.extension() == ".exr" || file.extension() == ".EXR") return describe_exr(file);
  const Image image = read_raster(file);
  Description out;
  out["size"] = {image.width, image.height};
  out["channels"] = image.channels;
  return out;
}

}  // namespace abbe
