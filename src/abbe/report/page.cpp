#include "abbe/report/page.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "abbe/report/embedded_page.h"

namespace abbe {
namespace {

// Puts texts in the places of a template, `{{name}}`, in one pass: what is put in stays as it is.
std::string filled(const std::string& text,
                   const std::vector<std::pair<std::string, std::string>>& values) {
  std::string out;
  std::size_t at = 0;
  while (true) {
    const std::size_t open = text.find("{{", at);
    const std::size_t close = open == std::string::npos ? open : text.find("}}", open);
    if (close == std::string::npos) return out + text.substr(at);
    out += text.substr(at, open - at);
    const std::string name = text.substr(open + 2, close - open - 2);
    for (const auto& [key, value] : values) {
      if (key == name) out += value;
    }
    at = close + 2;
  }
}

// JSON inside a script element: the only thing that could end the element is taken apart.
std::string script_json(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return out;
}

std::string page(const char* layout, const std::string& title, const std::string& json,
                 const std::vector<const char*>& scripts) {
  std::string code;
  for (const char* name : scripts) code += std::string(embedded_page_file(name)) + "\n";
  return filled(embedded_page_file(layout), {{"title", html_text(title)},
                                             {"css", embedded_page_file("page.css")},
                                             {"data", script_json(json)},
                                             {"scripts", code}});
}

}  // namespace

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string comparison_page(const std::string& title, const std::string& json) {
  return page("page.html", title, json,
              {"chart.min.js", "data.js", "viewer.js", "probe.js", "charts.js", "page.js"});
}

std::string golden_page(const std::string& title, const std::string& json) {
  return page("golden.html", title, json, {});
}

}  // namespace abbe
