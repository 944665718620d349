/// Diagrams as SVG: a frame with axes, and what is drawn in it.
#pragma once

#include <string>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// One axis. The values may fall: low and high say what stands at which end.
struct SvgAxis {
  std::string label;
  double low = 0.0;   ///< At the left, or at the bottom.
  double high = 1.0;  ///< At the right, or at the top.
};

/// A diagram in the making. Coordinates are the axes'; what lies outside the frame is cut off,
/// marks and labels excepted. Texts are escaped.
class SvgDiagram {
 public:
  SvgDiagram(std::string title, SvgAxis x, SvgAxis y, Vec2i frame_size_px);

  /// Makes room between the frame and the numbers of the x axis.
  void strip_below(int height_px);
  /// A cell of the strip below from one x to another.
  void strip_cell(double x_from, double x_to, const std::string& color);

  /// A filled rectangle without a border.
  void cell(const Vec2d& from, const Vec2d& to, const std::string& color);
  /// Begins a group that is cut off outside a polygon; ends with `end_clip`.
  void begin_clip(const std::vector<Vec2d>& polygon);
  void end_clip();
  void line(const std::vector<Vec2d>& points, const std::string& color, double width_px,
            bool dashed = false, bool closed = false);
  void dot(const Vec2d& at, double radius_px, const std::string& color);
  /// A text beside a point. `colour` may be empty for the colour of the axes.
  void label(const Vec2d& at, const Vec2d& offset_px, const std::string& text,
             const std::string& color = "", bool to_the_left = false);
  /// A text at the right, left, top or bottom of a dot, within the frame and clear of those set
  /// before; none where no place is free.
  void label_where_free(const Vec2d& at, const std::string& text);
  /// A line of the key at the right of the frame.
  void key(const std::string& text, const std::string& color, bool dashed = false);

  /// The whole document.
  std::string text() const;

 private:
  Vec2d at_px(const Vec2d& point) const;
  std::string points_px(const std::vector<Vec2d>& points) const;

  std::string title_;
  SvgAxis x_, y_;
  Vec2i frame_px_;
  int strip_px_ = 0;
  int clips_ = 0;
  struct Key {
    std::string text, color;
    bool dashed = false;
  };
  std::vector<Key> keys_;
  struct Box {
    Vec2d low, high;
  };
  std::vector<Box> taken_px_;
  std::string inside_, marks_, strip_;
};

/// Round numbers within an interval, about `count` of them, and their step.
std::vector<double> round_ticks(double low, double high, int count);

/// A text as XML takes it.
std::string svg_escaped(const std::string& text);

/// `#rrggbb` of encoded sRGB in [0, 1].
std::string svg_color(const Vec3d& rgb_srgb_encoded);

}  // namespace abbe
