#include "abbe/report/figures/rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/report/figures/cross_section.h"
#include "abbe/report/figures/svg.h"

namespace abbe {
namespace {

constexpr double kWidth_px = 820.0, kMaxHeight_px = 560.0, kLeastHeight_px = 200.0;
constexpr double kMargin_px = 28.0, kArc_px = 30.0, kNormal_px = 62.0, kRow_px = 20.0;
constexpr double kLetter_px = 6.3;
constexpr const char* kInk = "#222222";
constexpr const char* kFaint = "#8a8a8a";

struct Box {
  Vec2d low{1e300}, high{-1e300};
  void add(const Vec2d& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

class Drawing {
 public:
  Drawing(const RayFigure& figure, const World& world) : figure_(figure), plane_(plane_of(figure)) {
    Box box;
    for (const FigureRay& ray : figure.rays) {
      box.add(plane_.project(ray.from));
      box.add(plane_.project(ray.to));
    }
    for (const FigureCrossing& crossing : figure.crossings) {
      box.add(plane_.project(crossing.place));
    }
    const Vec2d size = glm::max(box.high - box.low, Vec2d(1e-12));
    const Vec2d room(kWidth_px - 2.0 * kMargin_px, kMaxHeight_px - 2.0 * kMargin_px);
    scale_ = std::min(room.x / size.x, room.y / size.y);
    height_px_ = std::clamp(size.y * scale_ + 2.0 * kMargin_px, kLeastHeight_px, kMaxHeight_px);
    middle_ = 0.5 * (box.low + box.high);
    top_px_ = 44.0 + 18.0 * static_cast<double>(figure.notes.size());
    draw_outlines(world);
    for (const FigureRay& ray : figure.rays) draw_ray(ray);
    for (std::size_t i = 0; i < figure.crossings.size(); ++i) draw_normal(i);
    for (std::size_t i = 0; i < figure.crossings.size(); ++i) draw_number(i);
    for (const FigureCrossing& crossing : figure.crossings) draw_angles(crossing);
  }

  std::string text() const {
    const double table_px =
        figure_.rows.empty() ? 0.0 : kRow_px * static_cast<double>(figure_.rows.size() + 1) + 16.0;
    const double key_px = figure_.key.empty() ? 0.0 : 44.0;
    const double bottom_px = top_px_ + height_px_;
    const double total_px = bottom_px + key_px + table_px + 16.0;
    std::string out = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
        "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"Helvetica, Arial, sans-serif\" "
        "font-size=\"12\" fill=\"{2}\">\n"
        "<title>{3}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        "<text x=\"{4:.0f}\" y=\"28\" font-size=\"16\" font-weight=\"bold\">{3}</text>\n",
        kWidth_px, total_px, kInk, svg_escaped(figure_.title), kMargin_px);
    double y = 48.0;
    for (const std::string& note : figure_.notes) {
      out += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" fill=\"#555555\">{}</text>\n", kMargin_px,
                         y, svg_escaped(note));
      y += 18.0;
    }
    out += fmt::format(
        "<clipPath id=\"frame\"><rect x=\"0\" y=\"{:.1f}\" width=\"{:.0f}\" height=\"{:.1f}\"/>"
        "</clipPath>\n<g clip-path=\"url(#frame)\" stroke-linecap=\"round\">\n",
        top_px_, kWidth_px, height_px_);
    out += lines_ + "</g>\n" + marks_;
    if (!figure_.key.empty()) out += key(bottom_px + 12.0);
    if (!figure_.rows.empty()) out += table(bottom_px + key_px + 24.0);
    return out + "</svg>\n";
  }

 private:
  Vec2d at_px(const Vec3d& p) const {
    const Vec2d d = (plane_.project(p) - middle_) * scale_;
    return {0.5 * kWidth_px + d.x, top_px_ + 0.5 * height_px_ - d.y};
  }

  void draw_outlines(const World& world) {
    std::vector<std::uint32_t> surfaces;
    for (const FigureCrossing& crossing : figure_.crossings) surfaces.push_back(crossing.surface);
    for (const std::vector<Vec3d>& line :
         cross_section(world, surfaces, plane_.normal, plane_.distance_m)) {
      std::string points;
      for (const Vec3d& p : line) {
        // Far outside, a number as large as the scene is of no use to a viewer.
        const Vec2d px = glm::clamp(at_px(p), Vec2d(-1e5), Vec2d(1e5));
        points += fmt::format("{}{:.2f},{:.2f}", points.empty() ? "" : " ", px.x, px.y);
      }
      lines_ += fmt::format(
          "<polyline points=\"{}\" fill=\"none\" stroke=\"#5b6b7a\" stroke-width=\"1.4\"/>\n",
          points);
    }
  }

  void draw_ray(const FigureRay& ray) {
    const Vec2d from = at_px(ray.from), to = at_px(ray.to);
    lines_ += fmt::format(
        "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" stroke=\"{}\" stroke-width=\"{:.1f}\"{}/>\n",
        from.x, from.y, to.x, to.y, ray.color, ray.width_px,
        ray.opacity < 0.995 ? fmt::format(" opacity=\"{:.2f}\"", ray.opacity) : "");
    const Vec2d along = to - from;
    const double length = glm::length(along);
    if (!ray.has_arrow || length < 12.0) return;
    const Vec2d u = along / length, v(-u.y, u.x);
    const Vec2d tip = from + 0.56 * along, back = tip - 9.0 * u;
    lines_ += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" fill=\"{}\"/>\n",
                          tip.x, tip.y, back.x + 3.6 * v.x, back.y + 3.6 * v.y, back.x - 3.6 * v.x,
                          back.y - 3.6 * v.y, ray.color);
  }

  // The unit direction on the page; none where it points at the reader.
  std::optional<Vec2d> on_page(const Vec3d& direction) const {
    const Vec2d d = plane_.project(direction);
    const double length = glm::length(d);
    if (length < 0.35) return std::nullopt;
    return Vec2d(d.x, -d.y) / length;
  }

  void draw_normal(std::size_t i) {
    const FigureCrossing& crossing = figure_.crossings[i];
    const auto normal = on_page(crossing.normal);
    if (!normal) return;
    const Vec2d a = at_px(crossing.place) - kNormal_px * *normal;
    const Vec2d b = at_px(crossing.place) + kNormal_px * *normal;
    lines_ += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"1\" "
        "stroke-dasharray=\"5 4\"/>\n",
        a.x, a.y, b.x, b.y, kFaint);
  }

  void draw_number(std::size_t i) {
    const Vec2d at = at_px(figure_.crossings[i].place);
    // Beside the point, away from the normal and from where the ray comes.
    const auto normal = on_page(figure_.crossings[i].normal);
    Vec2d aside = normal ? Vec2d(-normal->y, normal->x) : Vec2d(0.0, -1.0);
    const auto arrives = on_page(figure_.crossings[i].arrives);
    if (arrives && glm::dot(aside, *arrives) > 0.0) aside = -aside;
    for (const double distance : {17.0, -17.0, 34.0, -34.0}) {
      const Vec2d place = at + distance * aside;
      if (!is_free(place - Vec2d(8.0), place + Vec2d(8.0))) continue;
      taken_.push_back({place - Vec2d(8.0), place + Vec2d(8.0)});
      marks_ += fmt::format(
          "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"8\" fill=\"#ffffff\" stroke=\"{2}\"/>\n"
          "<text x=\"{0:.1f}\" y=\"{3:.1f}\" font-size=\"10.5\" "
          "text-anchor=\"middle\">{4}</text>\n",
          place.x, place.y, kInk, place.y + 3.8, i + 1);
      break;
    }
    marks_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/>\n", at.x, at.y,
                          kInk);
  }

  void draw_angles(const FigureCrossing& crossing) {
    const auto normal = on_page(crossing.normal);
    const auto back = on_page(-crossing.arrives);
    if (!normal || !back) return;
    const bool from_front = glm::dot(crossing.normal, crossing.arrives) < 0.0;
    const Vec2d near = from_front ? *normal : -*normal;
    draw_arc(at_px(crossing.place), near, *back, crossing.incidence_deg);
    if (!crossing.refracted || !crossing.refraction_deg) return;
    if (const auto forth = on_page(*crossing.refracted)) {
      draw_arc(at_px(crossing.place), -near, *forth, *crossing.refraction_deg);
    }
  }

  // Between two unit directions on the page, with the true angle in degrees beside it.
  void draw_arc(const Vec2d& center, const Vec2d& from, const Vec2d& to, double angle_deg) {
    const double turn = from.x * to.y - from.y * to.x;
    if (std::abs(turn) > 0.02) {
      const Vec2d a = center + kArc_px * from, b = center + kArc_px * to;
      lines_ += fmt::format(
          "<path d=\"M{:.1f} {:.1f}A{} {} 0 0 {} {:.1f} {:.1f}\" fill=\"none\" stroke=\"{}\" "
          "stroke-width=\"1\"/>\n",
          a.x, a.y, kArc_px, kArc_px, turn > 0.0 ? 1 : 0, b.x, b.y, kInk);
    }
    const std::string text = fmt::format("{:.2f}°", angle_deg);
    const double width = kLetter_px * static_cast<double>(text.size() - 1);
    const Vec2d between = glm::normalize(from + to + Vec2d(1e-9));
    for (const double radius : {kArc_px + 18.0, kArc_px + 32.0, kArc_px + 46.0}) {
      for (const double turn_deg : {0.0, 25.0, -25.0}) {
        const double t = turn_deg * std::numbers::pi / 180.0;
        const Vec2d along(between.x * std::cos(t) - between.y * std::sin(t),
                          between.x * std::sin(t) + between.y * std::cos(t));
        const Vec2d place = center + radius * along;
        const Vec2d low = place - Vec2d(0.5 * width, 7.0), high = place + Vec2d(0.5 * width, 7.0);
        if (!is_free(low, high)) continue;
        taken_.push_back({low, high});
        // A white edge keeps the number legible over rays.
        marks_ += fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\" text-anchor=\"middle\" "
            "stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\">{}</text>\n",
            place.x, place.y + 4.0, text);
        return;
      }
    }
  }

  bool is_free(const Vec2d& low, const Vec2d& high) const {
    if (low.x < 2.0 || high.x > kWidth_px - 2.0 || low.y < top_px_ ||
        high.y > top_px_ + height_px_) {
      return false;
    }
    return std::none_of(taken_.begin(), taken_.end(), [&](const Box& box) {
      return low.x < box.high.x && box.low.x < high.x && low.y < box.high.y && box.low.y < high.y;
    });
  }

  std::string key(double y) const {
    std::string out;
    const double step =
        (kWidth_px - 2.0 * kMargin_px - 20.0) / static_cast<double>(figure_.key.size());
    const double width = std::min(step, 90.0);
    // As many numbers as have room.
    const auto every = static_cast<std::size_t>(std::ceil(44.0 / width));
    for (std::size_t i = 0; i < figure_.key.size(); ++i) {
      const double x = kMargin_px + width * static_cast<double>(i);
      out += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"7\" fill=\"{}\"/>\n", x, y,
          width, figure_.key[i].second);
      if (i % every == 0) {
        out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\">{:.1f}</text>\n", x,
                           y + 20.0, figure_.key[i].first);
      }
    }
    out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\">nm</text>\n",
                       kMargin_px + width * static_cast<double>(figure_.key.size()) + 6.0, y + 8.0);
    return out;
  }

  std::string table(double y) const {
    std::vector<double> widths(figure_.columns.size(), 0.0);
    const auto widen = [&](const std::vector<std::string>& row) {
      for (std::size_t c = 0; c < widths.size(); ++c) {
        widths[c] = std::max(widths[c], kLetter_px * static_cast<double>(row[c].size()) + 18.0);
      }
    };
    widen(figure_.columns);
    for (const auto& row : figure_.rows) widen(row);
    std::string out = "<g font-size=\"11\">\n";
    const auto write = [&](const std::string& number, const std::vector<std::string>& row,
                           const char* style) {
      double x = kMargin_px;
      out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, style, number);
      x += 24.0;
      for (std::size_t c = 0; c < row.size(); ++c) {
        out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, style,
                           svg_escaped(row[c]));
        x += widths[c];
      }
      y += kRow_px;
    };
    write("", figure_.columns, " fill=\"#555555\"");
    for (std::size_t i = 0; i < figure_.rows.size(); ++i) {
      write(std::to_string(i + 1), figure_.rows[i], "");
    }
    return out + "</g>\n";
  }

  const RayFigure& figure_;
  FigurePlane plane_;
  double scale_ = 1.0, height_px_ = 0.0, top_px_ = 0.0;
  Vec2d middle_{0.0};
  std::vector<Box> taken_;
  std::string lines_, marks_;
};

}  // namespace

FigurePlane plane_of(const RayFigure& figure) {
  FigurePlane plane;
  Vec3d normal(0.0);
  for (const FigureCrossing& crossing : figure.crossings) {
    Vec3d across = glm::cross(crossing.arrives, crossing.normal);
    if (glm::dot(across, normal) < 0.0) across = -across;
    normal += across;
  }
  const Vec3d first = figure.rays.front().to - figure.rays.front().from;
  const double length = glm::length(first);
  const Vec3d forth = length > 0.0 ? first / length : Vec3d(1.0, 0.0, 0.0);
  if (glm::length(normal) < 1e-3) {
    normal = glm::cross(forth, Vec3d(0.0, 1.0, 0.0));
    if (glm::length(normal) < 1e-3) normal = Vec3d(0.0, 0.0, 1.0);
  }
  normal = glm::normalize(normal);
  if (std::abs(normal.y) > 0.9) {
    // Flat: seen from above, the first ray going right.
    plane.normal = normal.y > 0.0 ? normal : -normal;
    const Vec3d right = forth - glm::dot(forth, plane.normal) * plane.normal;
    plane.right = glm::length(right) > 1e-6 ? glm::normalize(right) : Vec3d(1.0, 0.0, 0.0);
    plane.up = glm::cross(plane.normal, plane.right);
  } else {
    plane.up = glm::normalize(Vec3d(0.0, 1.0, 0.0) - normal.y * normal);
    plane.right = glm::cross(plane.up, normal);
    if (glm::dot(plane.right, forth) < 0.0) plane.right = -plane.right;
    plane.normal = glm::cross(plane.right, plane.up);
  }
  double sum = 0.0;
  for (const FigureCrossing& crossing : figure.crossings) {
    sum += glm::dot(plane.normal, crossing.place);
  }
  plane.distance_m = figure.crossings.empty() ? glm::dot(plane.normal, figure.rays.front().from)
                                              : sum / static_cast<double>(figure.crossings.size());
  return plane;
}

std::string figure_svg(const RayFigure& figure, const World& world) {
  return Drawing(figure, world).text();
}

}  // namespace abbe
