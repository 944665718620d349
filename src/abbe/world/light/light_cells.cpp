#include "abbe/world/light/light_cells.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

constexpr float kFloatPi = static_cast<float>(kPi);

// The part of shares that rise from 0 to 1 that x falls into, and where in it.
int choose(const float* first, int count, float x, float& place, float& share) {
  int i = static_cast<int>(std::upper_bound(first, first + count, x) - first);
  i = std::min(i, count - 1);
  while (i > 0 && !(first[i] > first[i - 1])) --i;
  const float before = i > 0 ? first[i - 1] : 0.0f;
  share = first[i] - before;
  place = share > 0.0f ? std::clamp((x - before) / share, 0.0f, 1.0f) : 0.5f;
  return i;
}

}  // namespace

LightCells::LightCells(std::vector<float> light, int columns, std::vector<float> row_limits,
                       float first_turn)
    : columns_(columns), first_turn_(first_turn), row_limits_(std::move(row_limits)) {
  divide(light);
  if (!(nodes_.front().cell.power > 0.0 || !nodes_.front().is_cell)) return;
  number_cells(0, cells_);
  count_ = cells_.size();
  for (std::size_t i = 0; i < count_; ++i) {
    bound(i, cells_[i]);
    tabulate(cells_[i], light);
  }
  up_to_column_ = std::move(light);
}

Vec3f LightCells::direction_at(float column, float v) const {
  const float y = std::cos(kFloatPi * v);
  const float sine = std::sin(kFloatPi * v);
  const float angle = 2.0f * kFloatPi * (first_turn_ + column / static_cast<float>(columns_));
  return {sine * std::cos(angle), y, sine * std::sin(angle)};
}

float LightCells::solid_angle_of_part(int row) const {
  const float height = std::cos(kFloatPi * row_limits_[static_cast<std::size_t>(row)]) -
                       std::cos(kFloatPi * row_limits_[static_cast<std::size_t>(row) + 1]);
  return 2.0f * kFloatPi / static_cast<float>(columns_) * height;
}

LightCells::Node LightCells::cell_node(const std::vector<float>& light, Cell cell) const {
  cell.power = 0.0;
  for (int row = cell.first_row; row < cell.last_row; ++row) {
    const float* parts = light.data() + static_cast<std::size_t>(row) * columns_;
    double sum = 0.0;
    for (int column = cell.first_column; column < cell.last_column; ++column) {
      sum += static_cast<double>(parts[column]);
    }
    cell.power += sum * static_cast<double>(solid_angle_of_part(row));
  }
  Node node;
  node.cell = cell;
  return node;
}

// Always cuts the brightest cell in two, across its longer side.
void LightCells::divide(const std::vector<float>& light) {
  const int rows = static_cast<int>(row_limits_.size()) - 1;
  nodes_ = {cell_node(light, {0, rows, 0, columns_})};
  using Bright = std::pair<double, std::uint32_t>;
  std::priority_queue<Bright> bright;
  const auto offer = [&](std::uint32_t number) {
    const Cell& cell = nodes_[number].cell;
    const int parts = (cell.last_row - cell.first_row) * (cell.last_column - cell.first_column);
    if (parts > 1 && cell.power > 0.0) bright.push({cell.power, number});
  };
  offer(0);
  for (std::size_t count = 1; count < kMaxCells && !bright.empty(); ++count) {
    const std::uint32_t number = bright.top().second;
    bright.pop();
    const Cell cell = nodes_[number].cell;
    const auto limit = [&](int row) { return row_limits_[static_cast<std::size_t>(row)]; };
    const float top = limit(cell.first_row), bottom = limit(cell.last_row);
    const int columns = cell.last_column - cell.first_column;
    const float width = 2.0f * static_cast<float>(columns) / static_cast<float>(columns_) *
                        std::sin(kFloatPi * 0.5f * (top + bottom));
    const bool cuts_columns =
        cell.last_row - cell.first_row == 1 || (columns > 1 && width > bottom - top);
    Cell first = cell, second = cell;
    int cut = 0;
    if (cuts_columns) {
      cut = first.last_column = second.first_column = cell.first_column + columns / 2;
    } else {
      cut = first.last_row = second.first_row = (cell.first_row + cell.last_row) / 2;
    }
    const auto below = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(cell_node(light, first));
    nodes_.push_back(cell_node(light, second));
    Node& node = nodes_[number];
    node.is_cell = false;
    node.cuts_columns = cuts_columns;
    node.cut = cut;
    node.below = below;
    node.above = below + 1;
    offer(below);
    offer(below + 1);
  }
}

// Neighbours in the tree have numbers beside each other: what is stratified over the numbers is
// over directions.
void LightCells::number_cells(std::uint32_t number, std::vector<Cell>& cells) {
  Node& node = nodes_[number];
  if (node.is_cell) {
    node.below = static_cast<std::uint32_t>(cells.size());
    cells.push_back(node.cell);
    return;
  }
  number_cells(node.below, cells);
  number_cells(node.above, cells);
}

void LightCells::bound(std::size_t number, const Cell& cell) {
  constexpr int kSteps = 8;
  const float top = row_limits_[static_cast<std::size_t>(cell.first_row)];
  const float bottom = row_limits_[static_cast<std::size_t>(cell.last_row)];
  const auto at = [&](int i, int j) {
    const float share = static_cast<float>(i) / kSteps;
    return direction_at(static_cast<float>(cell.first_column) +
                            share * static_cast<float>(cell.last_column - cell.first_column),
                        top + static_cast<float>(j) / kSteps * (bottom - top));
  };
  const Vec3f axis = at(kSteps / 2, kSteps / 2);
  float widest = 0.0f, step = 0.0f;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const float chord = glm::length(at(i, j) - axis);
      widest = std::max(widest, 2.0f * std::asin(std::min(0.5f * chord, 1.0f)));
      if (i > 0) step = std::max(step, glm::length(at(i, j) - at(i - 1, j)));
      if (j > 0) step = std::max(step, glm::length(at(i, j) - at(i, j - 1)));
    }
  }
  // What lies between two of these directions is no farther than their distance from one of them.
  const float angle = std::min(1.01f * (widest + step) + 1e-5f, 0.5f * kFloatPi);
  power_[number] = static_cast<float>(cell.power);
  axis_x_[number] = axis.x;
  axis_y_[number] = axis.y;
  axis_z_[number] = axis.z;
  cos_[number] = std::cos(angle);
  sin_[number] = std::sin(angle);
}

void LightCells::tabulate(Cell& cell, std::vector<float>& light) {
  cell.rows = up_to_row_.size();
  double total = 0.0;
  std::vector<double> sums;
  for (int row = cell.first_row; row < cell.last_row; ++row) {
    float* parts = light.data() + static_cast<std::size_t>(row) * columns_;
    double sum = 0.0;
    for (int i = cell.first_column; i < cell.last_column; ++i) {
      sum += static_cast<double>(parts[i]);
    }
    total += sum * static_cast<double>(solid_angle_of_part(row));
    sums.push_back(total);
    double up_to = 0.0;
    for (int i = cell.first_column; i < cell.last_column; ++i) {
      up_to += static_cast<double>(parts[i]);
      parts[i] = sum > 0.0 ? static_cast<float>(up_to / sum) : 1.0f;
    }
  }
  for (const double up_to : sums) {
    up_to_row_.push_back(total > 0.0 ? static_cast<float>(up_to / total) : 1.0f);
  }
}

float LightCells::weight_of(std::size_t cell, const Vec3f& normal) const {
  if (normal == Vec3f(0.0f)) return power_[cell];
  const float cosine =
      axis_x_[cell] * normal.x + axis_y_[cell] * normal.y + axis_z_[cell] * normal.z;
  return power_[cell] * std::min(std::max(cos_[cell] * cosine + sin_[cell], 0.0f), 1.0f);
}

void LightCells::look(const Vec3f& normal, Seen& seen) const {
  if (normal == Vec3f(0.0f)) {
    seen.weight = power_;
  } else {
    // As weight_of(), without a branch for vectors' sake.
    for (std::size_t i = 0; i < kMaxCells; ++i) {
      const float cosine = axis_x_[i] * normal.x + axis_y_[i] * normal.y + axis_z_[i] * normal.z;
      seen.weight[i] = power_[i] * std::min(std::max(cos_[i] * cosine + sin_[i], 0.0f), 1.0f);
    }
  }
  constexpr std::size_t kInGroup = kMaxCells / Seen::kGroups;
  seen.group.fill(0.0f);
  for (std::size_t k = 0; k < kInGroup; ++k) {
    for (std::size_t g = 0; g < Seen::kGroups; ++g) seen.group[g] += seen.weight[g * kInGroup + k];
  }
  seen.total = 0.0f;
  for (const float sum : seen.group) seen.total += sum;
}

std::optional<LightCells::Draw> LightCells::draw(const Seen& seen, const Vec2f& u) const {
  if (!(seen.total > 0.0f)) return std::nullopt;
  constexpr std::size_t kInGroup = kMaxCells / Seen::kGroups;
  float left = u.x * seen.total;
  std::size_t group = 0, last_group = Seen::kGroups - 1;
  while (!(seen.group[last_group] > 0.0f)) --last_group;
  for (; group < last_group && !(left < seen.group[group]); ++group) left -= seen.group[group];
  std::size_t number = group * kInGroup, last = number + kInGroup - 1;
  while (!(seen.weight[last] > 0.0f)) --last;
  for (; number < last && !(left < seen.weight[number]); ++number) left -= seen.weight[number];
  const float along = std::clamp(left / seen.weight[number], 0.0f, 1.0f);

  const Cell& cell = cells_[number];
  float down = 0.0f, of_row = 0.0f, across = 0.0f, of_column = 0.0f;
  const int row = cell.first_row + choose(up_to_row_.data() + cell.rows,
                                          cell.last_row - cell.first_row, u.y, down, of_row);
  const float* shares = up_to_column_.data() + static_cast<std::size_t>(row) * columns_;
  const int column =
      cell.first_column + choose(shares + cell.first_column, cell.last_column - cell.first_column,
                                 along, across, of_column);
  if (!(of_row > 0.0f) || !(of_column > 0.0f)) return std::nullopt;
  const float top = std::cos(kFloatPi * row_limits_[static_cast<std::size_t>(row)]);
  const float bottom = std::cos(kFloatPi * row_limits_[static_cast<std::size_t>(row) + 1]);
  const float y = top + down * (bottom - top);
  const float sine = std::sqrt(std::max(0.0f, 1.0f - y * y));
  const float angle =
      2.0f * kFloatPi *
      (first_turn_ + (static_cast<float>(column) + across) / static_cast<float>(columns_));
  return Draw{{sine * std::cos(angle), y, sine * std::sin(angle)},
              seen.weight[number] / seen.total * of_row * of_column / solid_angle_of_part(row)};
}

float LightCells::density(const Vec3f& normal, float total, const Vec3f& direction) const {
  if (!(total > 0.0f)) return 0.0f;
  const float v = std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / kFloatPi;
  const auto limit = std::upper_bound(row_limits_.begin() + 1, row_limits_.end() - 1, v);
  const int row = static_cast<int>(limit - row_limits_.begin()) - 1;
  const float turns = std::atan2(direction.z, direction.x) / (2.0f * kFloatPi) - first_turn_;
  const int column = std::min(
      static_cast<int>((turns - std::floor(turns)) * static_cast<float>(columns_)), columns_ - 1);
  const Node* node = &nodes_.front();
  while (!node->is_cell) {
    const bool is_below = (node->cuts_columns ? column : row) < node->cut;
    node = &nodes_[is_below ? node->below : node->above];
  }
  const std::size_t number = node->below;
  const Cell& cell = cells_[number];
  const float* rows = up_to_row_.data() + cell.rows;
  const int in_cell = row - cell.first_row;
  const float of_row = rows[in_cell] - (in_cell > 0 ? rows[in_cell - 1] : 0.0f);
  const float* shares = up_to_column_.data() + static_cast<std::size_t>(row) * columns_;
  const float of_column = shares[column] - (column > cell.first_column ? shares[column - 1] : 0.0f);
  return weight_of(number, normal) / total * of_row * of_column / solid_angle_of_part(row);
}

}  // namespace abbe
