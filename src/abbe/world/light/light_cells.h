/// Directions drawn by the light of an image of all directions, and by how it falls on a surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// An equirectangular image in cells that bring about as much light each, bright ones down to
/// single parts of it: for a surface each is weighed by its light and by a bound on the cosine of
/// its directions, so that what is below the horizon is not drawn.
class LightCells {
 public:
  static constexpr std::size_t kMaxCells = 256;

  LightCells() = default;
  /// Shape:  `light` has a value per part, rows of `columns`, from above (+y) down: its mean
  ///         radiance. Row i reaches from row_limits[i] to [i + 1], shares of π from +y. The first
  ///         column begins `first_turn` turns from +x to +z.
  LightCells(std::vector<float> light, int columns, std::vector<float> row_limits,
             float first_turn);

  /// Whether there is no light at all.
  bool is_empty() const { return count_ == 0; }

  /// The weights of all cells for a surface.
  struct Seen {
    static constexpr std::size_t kGroups = 16;
    alignas(64) std::array<float, kMaxCells> weight;
    std::array<float, kGroups> group;  ///< Sums of kMaxCells / kGroups weights each.
    float total;
  };
  /// Shape: `normal` of unit length, on the side that light comes from; 0: from all around.
  void look(const Vec3f& normal, Seen& seen) const;

  /// A direction and its density.
  struct Draw {
    Vec3f direction{0.0f};
    float density = 0.0f;  ///< Per steradian, > 0.
  };
  /// A direction drawn by the weights of cells and by the light of the parts in them, evenly within
  /// a part. Absent where no light comes from above the horizon.
  /// Domain: u in [0, 1)².
  std::optional<Draw> draw(const Seen& seen, const Vec2f& u) const;
  /// The density of draw() in a direction, per steradian; 0 where it never draws.
  /// Units:  `total` is that of what the normal sees.
  float density(const Vec3f& normal, float total, const Vec3f& direction) const;

 private:
  struct Cell {
    int first_row = 0, last_row = 0, first_column = 0, last_column = 0;  ///< Half-open.
    double power = 0.0;
    std::size_t rows = 0;  ///< Of its rows in up_to_row_.
  };
  // Of the tree that finds cells: a cut at a row or column, or a cell.
  struct Node {
    bool is_cell = true, cuts_columns = false;
    int cut = 0;
    std::uint32_t below = 0, above = 0;  ///< Nodes; of a cell `below` is its number.
    Cell cell;
  };

  Node cell_node(const std::vector<float>& light, Cell cell) const;
  void divide(const std::vector<float>& light);
  void number_cells(std::uint32_t number, std::vector<Cell>& cells);
  void bound(std::size_t number, const Cell& cell);
  void tabulate(Cell& cell, std::vector<float>& light);
  Vec3f direction_at(float column, float v) const;
  float solid_angle_of_part(int row) const;
  float weight_of(std::size_t cell, const Vec3f& normal) const;

  int columns_ = 0;
  float first_turn_ = 0.0f;
  std::vector<float> row_limits_;
  std::vector<Node> nodes_;
  std::vector<Cell> cells_;
  std::vector<float> up_to_row_;     ///< Share of a cell's light above the end of a row.
  std::vector<float> up_to_column_;  ///< In its row and cell, left of the end of a column.
  // Per cell; all directions of it have at most the cosine cos·(axis · normal) + sin.
  std::size_t count_ = 0;
  alignas(64) std::array<float, kMaxCells> power_{}, axis_x_{}, axis_y_{}, axis_z_{}, cos_{},
      sin_{};
};

}  // namespace abbe
