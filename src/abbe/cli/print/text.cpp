#include "abbe/cli/print/text.h"

#include <fmt/format.h>

#include <cstdio>

#include "abbe/base/error.h"
#include "abbe/base/text.h"

namespace abbe {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLineWidth = 110;

std::string scalar_text(const Json& value) {
  if (value.is_string()) return printable(value.get<std::string>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.dump();
}

bool is_scalar(const Json& value) {
  return !value.is_structured();
}

bool holds_scalars(const Json& value) {
  for (const Json& element : value) {
    if (!is_scalar(element)) return false;
  }
  return true;
}

// A value that fits behind its name: a scalar, or a short list of them.
std::optional<std::string> short_text(const Json& value) {
  if (is_scalar(value)) return scalar_text(value);
  if (!value.is_array() || !holds_scalars(value)) return std::nullopt;
  std::string text;
  for (const Json& element : value) {
    // Numbers of a vector by blanks, names by commas.
    if (!text.empty()) text += element.is_number() ? " " : ", ";
    text += scalar_text(element);
  }
  if (text.size() > kLineWidth) return std::nullopt;
  return text;
}

void append(const Json& value, std::size_t indent, std::string& out);

// `name` opens the entry of a list of things; the rest goes behind it while it fits.
void append_element(const Json& element, std::size_t indent, std::string& out) {
  const std::string margin(indent, ' ');
  if (!element.is_object()) {
    out += margin + short_text(element).value_or("...") + "\n";
    return;
  }
  std::string line = margin;
  bool is_first = true;
  Json rest = Json::object();
  std::size_t width = 0;
  for (const auto& [name, value] : element.items()) {
    const std::optional<std::string> text = short_text(value);
    if (!text) {
      rest[name] = value;
      continue;
    }
    if (text->empty() || value.is_null()) continue;
    const std::string item = is_first ? *text : name + " " + *text;
    if (!is_first) {
      line += ",";
      width += 1;
      if (width + item.size() > kLineWidth) {
        line += "\n" + margin + "   ";
        width = indent + 3;
      }
      line += " ";
      width += 1;
    }
    line += item;
    width += item.size();
    is_first = false;
  }
  out += line + "\n";
  if (!rest.empty()) append(rest, indent + 4, out);
}

void append(const Json& value, std::size_t indent, std::string& out) {
  const std::string margin(indent, ' ');
  for (const auto& [name, member] : value.items()) {
    if (const std::optional<std::string> text = short_text(member); text && !member.is_array()) {
      out += fmt::format("{}{}: {}\n", margin, name, *text);
    } else if (member.is_array() && !member.empty() && holds_scalars(member) && text) {
      out += fmt::format("{}{}: {}\n", margin, name, *text);
    } else if (member.is_array()) {
      if (member.empty()) {
        out += fmt::format("{}{}: none\n", margin, name);
        continue;
      }
      out += fmt::format("{}{}:\n", margin, name);
      for (const Json& element : member) append_element(element, indent + 2, out);
    } else {
      out += fmt::format("{}{}:\n", margin, name);
      append(member, indent + 2, out);
    }
  }
}

}  // namespace

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw_output_error("stdout", "an error while writing", "a place that takes the text");
  }
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string plain_text(const Json& json) {
  std::string out;
  append(json, 0, out);
  return out;
}

}  // namespace abbe
