#include "abbe/report/golden/list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/report/json.h"
#include "abbe/report/page.h"

namespace abbe {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxListBytes = 16u << 20;

std::string text_field(const Json& entry, const char* name, const std::string& where) {
  const auto found = entry.find(name);
  if (found == entry.end() || !found->is_string()) {
    throw_input_error(where, std::string("no text \"") + name + "\"", "one in every image");
  }
  return found->get<std::string>();
}

double number_field(const Json& entry, const char* name, const std::string& where) {
  const auto found = entry.find(name);
  if (found == entry.end() || !found->is_number() || !(found->get<double>() >= 0.0)) {
    throw_input_error(where, std::string("no number \"") + name + "\"", "one of 0 or more");
  }
  return found->get<double>();
}

GoldenImage image_of(const Json& entry, const std::string& where) {
  GoldenImage image;
  image.name = text_field(entry, "name", where);
  if (!is_golden_name(image.name)) {
    throw_input_error(where, "name \"" + image.name + "\"",
                      "letters, digits, _, - and . behind them");
  }
  image.scene = text_field(entry, "scene", where);
  image.command = text_field(entry, "command", where);
  const auto tolerance = entry.find("tolerance");
  if (tolerance == entry.end() || !tolerance->is_object()) {
    throw_input_error(where, "no \"tolerance\"", "fail, fail_percent and hard_fail");
  }
  image.thresholds.fail = number_field(*tolerance, "fail", where);
  image.thresholds.fail_percent = number_field(*tolerance, "fail_percent", where);
  image.thresholds.hard_fail = number_field(*tolerance, "hard_fail", where);
  return image;
}

}  // namespace

bool is_golden_name(const std::string& name) {
  return !name.empty() && name.size() <= 200 && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
         });
}

std::vector<GoldenImage> read_golden_list(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kGoldenList;
  const std::vector<std::uint8_t> bytes = read_file(file, file.string(), kMaxListBytes);
  Json list;
  try {
    list = Json::parse(bytes.begin(), bytes.end());
  } catch (const Json::exception& error) {
    // The library's text names its exception first, then the place.
    const std::string cause = error.what();
    throw_input_error(file.string(), cause.substr(cause.find("] ") + 2), "JSON");
  }
  const auto entries = list.is_object() ? list.find("images") : list.end();
  if (!list.is_object() || entries == list.end() || !entries->is_array()) {
    throw_input_error(file.string(), "no list of golden images", "{\"images\": […]}");
  }
  std::vector<GoldenImage> images;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const std::string where = fmt::format("{}: /images/{}", file.string(), i);
    if (!(*entries)[i].is_object()) throw_input_error(where, "no object", "an image");
    images.push_back(image_of((*entries)[i], where));
    for (std::size_t j = 0; j < i; ++j) {
      if (images[j].name == images[i].name) {
        throw_input_error(where, "name \"" + images[i].name + "\" twice", "each once");
      }
    }
  }
  return images;
}

void write_golden_list(const std::filesystem::path& folder,
                       const std::vector<GoldenImage>& images) {
  Json list;
  list["about"] =
      "Scene-linear reference images, NAME.exr each, for `abbe golden check`. A pixel fails when a "
      "channel differs by more than fail; the image when more than fail_percent of its pixels "
      "fail, "
      "or one value differs by more than hard_fail.";
  list["images"] = Json::array();
  for (const GoldenImage& image : images) {
    list["images"].push_back({{"name", image.name},
                              {"scene", image.scene},
                              {"command", image.command},
                              {"tolerance",
                               {{"fail", image.thresholds.fail},
                                {"fail_percent", image.thresholds.fail_percent},
                                {"hard_fail", image.thresholds.hard_fail}}}});
  }
  write_text(folder / kGoldenList, document_text(list));
}

std::string golden_summary(const std::vector<GoldenResult>& results) {
  const auto passed = std::count_if(results.begin(), results.end(),
                                    [](const GoldenResult& result) { return result.passed; });
  return fmt::format("{} of {} golden images passed.", passed, results.size());
}

std::string golden_results_page(const std::vector<GoldenResult>& results) {
  Json page;
  page["images"] = Json::array();
  for (const bool passed : {false, true}) {
    for (const GoldenResult& result : results) {
      if (result.passed != passed) continue;
      Json entry = {{"name", result.name}, {"passed", passed}, {"text", result.message}};
      if (!passed) entry["command"] = result.command;
      for (const auto& [caption, uri] : result.pictures) entry["pictures"][caption] = uri;
      page["images"].push_back(std::move(entry));
    }
  }
  page["summary"] = golden_summary(results);
  return golden_page("abbe golden check", document_text(page));
}

std::string junit_xml(const std::string& suite, const std::vector<GoldenResult>& results) {
  const auto failures = std::count_if(results.begin(), results.end(),
                                      [](const GoldenResult& result) { return !result.passed; });
  double seconds = 0.0;
  for (const GoldenResult& result : results) seconds += result.seconds;
  // Characters that XML cannot hold, whatever the entity, become blanks.
  const auto text = [](std::string plain) {
    for (char& c : plain) {
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') c = ' ';
    }
    return html_text(plain);
  };
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  xml += fmt::format(
      "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" time=\"{:.3f}\">\n",
      text(suite), results.size(), failures, seconds);
  for (const GoldenResult& result : results) {
    xml += fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\"", text(suite),
                       text(result.name), result.seconds);
    if (result.passed) {
      xml += "/>\n";
    } else {
      xml += fmt::format(">\n      <failure message=\"{}\"/>\n    </testcase>\n",
                         text(result.message));
    }
  }
  return xml + "  </testsuite>\n</testsuites>\n";
}

}  // namespace abbe
