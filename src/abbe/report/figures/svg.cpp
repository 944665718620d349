#include "abbe/report/figures/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/text.h"
#include "abbe/report/page.h"

namespace abbe {
namespace {

constexpr int kLeft_px = 78, kTop_px = 46, kBottom_px = 62, kRight_px = 28, kKey_px = 22;
constexpr double kLetter_px = 7.2;  // Of a sans-serif of 13 px, on the safe side.
constexpr const char* kInk = "#222222";

double step_of(double low, double high, int count) {
  const double rough = std::abs(high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power * 1.0001) return factor * power;
  }
  return 10.0 * power;
}

std::string tick_text(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  if (std::abs(value) >= 1e6 || decimals > 6) return fmt::format("{:.3g}", value);
  return fmt::format("{:.{}f}", std::abs(value) < 1e-12 ? 0.0 : value, decimals);
}

}  // namespace

std::string svg_escaped(const std::string& text) {
  // XML has no control characters at all, not even escaped ones.
  return html_text(printable(text));
}

std::vector<double> round_ticks(double low, double high, int count) {
  const double first = std::min(low, high), last = std::max(low, high);
  const double step = step_of(first, last, count);
  std::vector<double> ticks;
  for (double i = std::ceil(first / step - 1e-9); i * step <= last + 1e-9 * step; i += 1.0) {
    ticks.push_back(i * step);
  }
  return ticks;
}

std::string svg_color(const Vec3d& rgb_srgb_encoded) {
  const auto byte = [](double value) {
    return static_cast<int>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(rgb_srgb_encoded.x), byte(rgb_srgb_encoded.y),
                     byte(rgb_srgb_encoded.z));
}

SvgDiagram::SvgDiagram(std::string title, SvgAxis x, SvgAxis y, Vec2i frame_size_px)
    : title_(std::move(title)), x_(std::move(x)), y_(std::move(y)), frame_px_(frame_size_px) {}

Vec2d SvgDiagram::at_px(const Vec2d& point) const {
  return {kLeft_px + frame_px_.x * (point.x - x_.low) / (x_.high - x_.low),
          kTop_px + frame_px_.y * (1.0 - (point.y - y_.low) / (y_.high - y_.low))};
}

std::string SvgDiagram::points_px(const std::vector<Vec2d>& points) const {
  std::string text;
  for (const Vec2d& point : points) {
    const Vec2d px = at_px(point);
    text += fmt::format("{}{:.2f},{:.2f}", text.empty() ? "" : " ", px.x, px.y);
  }
  return text;
}

void SvgDiagram::strip_below(int height_px) {
  strip_px_ = height_px;
}

void SvgDiagram::strip_cell(double x_from, double x_to, const std::string& color) {
  const double left = at_px({x_from, 0.0}).x, right = at_px({x_to, 0.0}).x;
  strip_ +=
      fmt::format("<rect x=\"{:.2f}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\" fill=\"{}\"/>\n",
                  left, kTop_px + frame_px_.y, right - left, strip_px_, color);
}

void SvgDiagram::cell(const Vec2d& from, const Vec2d& to, const std::string& color) {
  const Vec2d a = at_px(from), b = at_px(to);
  inside_ += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
      std::min(a.x, b.x), std::min(a.y, b.y), std::abs(b.x - a.x), std::abs(b.y - a.y), color);
}

void SvgDiagram::begin_clip(const std::vector<Vec2d>& polygon) {
  ++clips_;
  inside_ += fmt::format(
      "<clipPath id=\"clip{0}\"><polygon points=\"{1}\"/></clipPath>\n"
      "<g clip-path=\"url(#clip{0})\" shape-rendering=\"crispEdges\">\n",
      clips_, points_px(polygon));
}

void SvgDiagram::end_clip() {
  inside_ += "</g>\n";
}

void SvgDiagram::line(const std::vector<Vec2d>& points, const std::string& color, double width_px,
                      bool dashed, bool closed) {
  inside_ += fmt::format(
      "<{} points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
      "stroke-linejoin=\"round\"{}/>\n",
      closed ? "polygon" : "polyline", points_px(points), color, width_px,
      dashed ? " stroke-dasharray=\"6 4\"" : "");
}

void SvgDiagram::dot(const Vec2d& at, double radius_px, const std::string& color) {
  const Vec2d px = at_px(at);
  marks_ += fmt::format(
      "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\" fill=\"{}\" stroke=\"#ffffff\" "
      "stroke-width=\"0.8\"/>\n",
      px.x, px.y, radius_px, color);
  taken_px_.push_back({px - Vec2d(radius_px), px + Vec2d(radius_px)});
}

void SvgDiagram::label(const Vec2d& at, const Vec2d& offset_px, const std::string& text,
                       const std::string& color, bool to_the_left) {
  const Vec2d px = at_px(at) + offset_px;
  marks_ += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\" fill=\"{}\"{}>{}</text>\n", px.x, px.y,
      color.empty() ? kInk : color, to_the_left ? " text-anchor=\"end\"" : "", svg_escaped(text));
}

void SvgDiagram::label_where_free(const Vec2d& at, const std::string& text) {
  constexpr double kLetterOfLabel_px = 6.1, kAscent_px = 9.0, kDescent_px = 3.0;
  const double width = kLetterOfLabel_px * static_cast<double>(text.size());
  const Vec2d frame_low{kLeft_px, kTop_px};
  const Vec2d frame_high = frame_low + Vec2d(frame_px_);
  for (const Vec2d& offset : {Vec2d{7.0, 4.0}, Vec2d{-7.0 - width, 4.0}, Vec2d{-0.5 * width, -7.0},
                              Vec2d{-0.5 * width, 16.0}}) {
    const Vec2d start = at_px(at) + offset;
    const Box box{{start.x, start.y - kAscent_px}, {start.x + width, start.y + kDescent_px}};
    const bool is_inside = box.low.x >= frame_low.x && box.low.y >= frame_low.y &&
                           box.high.x <= frame_high.x && box.high.y <= frame_high.y;
    const bool is_free = std::none_of(taken_px_.begin(), taken_px_.end(), [&](const Box& other) {
      return box.low.x < other.high.x && other.low.x < box.high.x && box.low.y < other.high.y &&
             other.low.y < box.high.y;
    });
    if (!is_inside || !is_free) continue;
    taken_px_.push_back(box);
    label(at, offset, text);
    return;
  }
}

void SvgDiagram::key(const std::string& text, const std::string& color, bool dashed) {
  keys_.push_back({text, color, dashed});
}

std::string SvgDiagram::text() const {
  std::size_t longest = 0;
  for (const Key& key : keys_) longest = std::max(longest, key.text.size());
  const int key_width =
      keys_.empty() ? 0 : 40 + static_cast<int>(kLetter_px * static_cast<double>(longest));
  const int width = kLeft_px + frame_px_.x + kRight_px + key_width;
  const int needed = kTop_px + kKey_px * (static_cast<int>(keys_.size()) + 1);
  const int height = std::max(kTop_px + frame_px_.y + strip_px_ + kBottom_px, needed);
  const int right = kLeft_px + frame_px_.x, bottom = kTop_px + frame_px_.y;

  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\">\n"
      "<title>{2}</title>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n"
      "<text x=\"{3}\" y=\"{4}\" font-size=\"16\" font-weight=\"bold\" fill=\"{5}\">{2}</text>\n",
      width, height, svg_escaped(title_), kLeft_px, kTop_px - 16, kInk);
  out += fmt::format(
      "<clipPath id=\"frame\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
      kLeft_px, kTop_px, frame_px_.x, frame_px_.y);

  std::string grid, numbers;
  constexpr int kTicks_x = 10, kTicks_y = 7;
  const std::vector<double> ticks_x = round_ticks(x_.low, x_.high, kTicks_x);
  const std::vector<double> ticks_y = round_ticks(y_.low, y_.high, kTicks_y);
  for (const double tick : ticks_x) {
    const double x = at_px({tick, y_.low}).x;
    grid += fmt::format("<path d=\"M{0:.2f} {1}V{2}\"/>\n", x, kTop_px, bottom);
    numbers +=
        fmt::format("<text x=\"{:.2f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x,
                    bottom + strip_px_ + 18, tick_text(tick, step_of(x_.low, x_.high, kTicks_x)));
  }
  for (const double tick : ticks_y) {
    const double y = at_px({x_.low, tick}).y;
    grid += fmt::format("<path d=\"M{0} {1:.2f}H{2}\"/>\n", kLeft_px, y, right);
    numbers +=
        fmt::format("<text x=\"{}\" y=\"{:.2f}\" text-anchor=\"end\">{}</text>\n", kLeft_px - 8,
                    y + 4.5, tick_text(tick, step_of(y_.low, y_.high, kTicks_y)));
  }
  out += "<g stroke=\"#dddddd\" stroke-width=\"1\">\n" + grid + "</g>\n";
  if (!strip_.empty()) out += "<g shape-rendering=\"crispEdges\">\n" + strip_ + "</g>\n";
  out += "<g clip-path=\"url(#frame)\">\n" + inside_ + "</g>\n";
  out += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{}\"/>\n",
      kLeft_px, kTop_px, frame_px_.x, frame_px_.y, kInk);
  out += marks_ + fmt::format("<g fill=\"{}\">\n", kInk) + numbers;
  out += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     kLeft_px + 0.5 * frame_px_.x, bottom + strip_px_ + 44, svg_escaped(x_.label));
  out += fmt::format(
      "<text transform=\"translate(20 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      kTop_px + 0.5 * frame_px_.y, svg_escaped(y_.label));
  int y = kTop_px + 14;
  for (const Key& key : keys_) {
    out += fmt::format(
        "<path d=\"M{} {}h26\" stroke=\"{}\" stroke-width=\"2.5\"{}/>\n"
        "<text x=\"{}\" y=\"{}\">{}</text>\n",
        right + 16, y - 4, key.color, key.dashed ? " stroke-dasharray=\"6 4\"" : "", right + 48, y,
        svg_escaped(key.text));
    y += kKey_px;
  }
  return out + "</g>\n</svg>\n";
}

}  // namespace abbe
