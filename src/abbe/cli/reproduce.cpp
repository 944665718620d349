#include "abbe/cli/reproduce.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <variant>

#include "abbe/color/uplift/uplift.h"

namespace abbe {
namespace {

std::optional<std::string> text_of(const ExrHeader& header, const std::string& name) {
  const auto found = header.attributes.find(name);
  if (found == header.attributes.end()) return std::nullopt;
  return std::visit(
      [](const auto& value) {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>)
          return value;
        else
          return fmt::format("{}", value);
      },
      found->second);
}

// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string("-_./:,=+%@").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string before(const std::string& text, const std::string& end) {
  return text.substr(0, text.find(end));
}

/// An attribute and the option that it is the value of, up to a text that ends it.
struct Setting {
  const char* attribute;
  const char* option;
  const char* end;
};

constexpr std::array<Setting, 18> kSettings{{{"abbe:scene", "--scene", nullptr},
                                             {"abbe:mode", "--mode", nullptr},
                                             {"abbe:samples", "--spp", nullptr},
                                             {"abbe:wavelengths", "--wavelengths", nullptr},
                                             {"abbe:range", "--range", " nm"},
                                             {"abbe:lines", "--lines", " nm"},
                                             {"abbe:bands", "--bands", " nm"},
                                             {"abbe:filter", "--filter", nullptr},
                                             {"abbe:depth", "--depth", nullptr},
                                             {"abbe:cutoff", "--cutoff", nullptr},
                                             {"abbe:seed", "--seed", nullptr},
                                             {"abbe:caustics", "--caustics", nullptr},
                                             {"abbe:chain", "--chain", nullptr},
                                             {"abbe:lamp", "--lamp", nullptr},
                                             {"abbe:aov", "--aov", nullptr},
                                             {"abbe:freeze", "--freeze", nullptr},
                                             {"abbe:white", "--white", nullptr},
                                             {"abbe:adaptation", "--adaptation", " "}}};

std::string window_options(const ExrHeader& header) {
  if (header.full_size == Vec2i(0)) {
    return fmt::format(" --size {}x{}", header.width, header.height);
  }
  const Vec2i from = header.data_origin;
  return fmt::format(" --size {}x{} --crop {},{},{},{}", header.full_size.x, header.full_size.y,
                     from.x, from.y, from.x + header.width, from.y + header.height);
}

std::string form_options(const ExrHeader& header) {
  std::string options = " --compression " + header.compression;
  if (header.tile_size > 0) options += fmt::format(" --tiles {}", header.tile_size);
  if (header.part_count > 1) options += " --multipart";
  const bool has_half =
      std::any_of(header.channels.begin(), header.channels.end(),
                  [](const ExrHeader::Channel& channel) { return channel.type == "half"; });
  if (has_half) options += " --half";
  return options;
}

}  // namespace

std::optional<std::string> render_command_of(const ExrHeader& header) {
  if (!text_of(header, "abbe:version") || !text_of(header, "abbe:mode") ||
      text_of(header, "abbe:developed")) {
    return std::nullopt;
  }
  std::string command;
  if (const auto isa = text_of(header, "abbe:isa")) command += "ABBE_ISA=" + quoted(*isa) + " ";
  command += "abbe render SCENE -o OUT.exr" + window_options(header);
  for (const Setting& setting : kSettings) {
    const auto value = text_of(header, setting.attribute);
    if (!value) continue;
    command += std::string(" ") + setting.option + " " +
               quoted(setting.end != nullptr ? before(*value, setting.end) : *value);
  }
  const auto uplift = text_of(header, "abbe:uplift");
  if (uplift && uplift->starts_with(uplift_title(Uplift::MallettYuksel))) {
    command += " --uplift " + uplift_name(Uplift::MallettYuksel);
  }
  const auto camera = text_of(header, "abbe:camera");
  if (camera && *camera != "default") command += " --camera " + quoted(*camera);
  if (text_of(header, "abbe:drop") == "1") command += " --drop";
  if (const auto observer = text_of(header, "abbe:observer")) {
    const std::string id = before(*observer, ",");
    command += " --observer " + (id.starts_with("csv:") ? std::string("FILE.csv") : quoted(id));
  }
  if (const auto space = text_of(header, "abbe:primaries")) {
    command += " --colorspace " + quoted(*space);
  }
  return command + form_options(header);
}

}  // namespace abbe
