#include "support/forward/setup.h"

#include <algorithm>
#include <cmath>

namespace abbe::test {

double GlassIndex::at(double wavelength_nm) const {
  if (B.empty()) return constant;
  const double square = wavelength_nm * wavelength_nm * 1e-6;
  double n2 = 1.0;
  for (std::size_t i = 0; i < B.size(); ++i) n2 += B[i] * square / (square - C[i]);
  return std::sqrt(n2);
}

GlassIndex n_bk7() {
  return {.B = {1.03961212, 0.231792344, 1.01046945},
          .C = {0.00600069867, 0.0200179144, 103.560653}};
}
GlassIndex n_sf11() {
  return {.B = {1.73759695, 0.313747346, 1.89878101}, .C = {0.013188707, 0.0623068142, 155.23629}};
}

FlatFaces swept(const std::vector<Vec2d>& outline, double z0, double z1) {
  FlatFaces faces(2);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2d& a = outline[i];
    const Vec2d& b = outline[(i + 1) % outline.size()];
    faces[0].insert(faces[0].begin(), Vec3d(a, z0));
    faces[1].push_back(Vec3d(a, z1));
    faces.push_back({Vec3d(a, z0), Vec3d(b, z0), Vec3d(b, z1), Vec3d(a, z1)});
  }
  return faces;
}

FlatFaces box(const Vec3d& center, const Vec3d& half) {
  const Vec3d low = center - half;
  const Vec3d high = center + half;
  return swept({{low.x, low.y}, {high.x, low.y}, {high.x, high.y}, {low.x, high.y}}, low.z, high.z);
}

FlatFaces convex(const std::vector<Vec4d>& planes) {
  FlatFaces faces;
  for (const Vec4d& plane : planes) {
    const Vec3d normal = glm::normalize(Vec3d(plane));
    const Vec3d helper = std::abs(normal.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d u = glm::normalize(glm::cross(helper, normal));
    const Vec3d v = glm::cross(normal, u);
    const Vec3d middle = normal * (plane.w / glm::length(Vec3d(plane)));
    // A square wider than any body, cut by all other planes (Sutherland and Hodgman).
    FlatFace face = {middle - 1e3 * u - 1e3 * v, middle + 1e3 * u - 1e3 * v,
                     middle + 1e3 * u + 1e3 * v, middle - 1e3 * u + 1e3 * v};
    for (const Vec4d& cut : planes) {
      if (&cut == &plane) continue;
      FlatFace kept;
      for (std::size_t i = 0; i < face.size(); ++i) {
        const Vec3d& a = face[i];
        const Vec3d& b = face[(i + 1) % face.size()];
        const double over_a = glm::dot(Vec3d(cut), a) - cut.w;
        const double over_b = glm::dot(Vec3d(cut), b) - cut.w;
        if (over_a <= 0.0) kept.push_back(a);
        if ((over_a < 0.0) != (over_b < 0.0) && over_a != over_b)
          kept.push_back(a + (b - a) * (over_a / (over_a - over_b)));
      }
      face = std::move(kept);
    }
    // Planes that meet in one corner cut it more than once.
    FlatFace clean;
    for (const Vec3d& corner : face)
      if (clean.empty() || (glm::distance(corner, clean.back()) > 1e-9 &&
                            glm::distance(corner, clean.front()) > 1e-9))
        clean.push_back(corner);
    if (clean.size() >= 3) faces.push_back(clean);
  }
  return faces;
}

FlatFaces cup(const Vec3d& center, const Vec3d& half, const Vec2d& inner, double bottom) {
  const Vec3d low = center - half;
  const Vec3d high = center + half;
  const Vec3d cavity_low(center.x - inner.x, bottom, center.z - inner.y);
  const Vec3d cavity_high(center.x + inner.x, high.y, center.z + inner.y);
  const auto has_no_lid = [&](FlatFaces faces) {
    std::erase_if(faces, [&](const FlatFace& face) {
      return std::all_of(face.begin(), face.end(), [&](const Vec3d& c) { return c.y == high.y; });
    });
    return faces;
  };
  FlatFaces faces = joined(has_no_lid(box(center, half)),
                           turned_over(has_no_lid(box(0.5 * (cavity_low + cavity_high),
                                                      0.5 * (cavity_high - cavity_low)))));
  const auto ring = [&](const Vec3d& a, const Vec3d& b) {
    return FlatFace{{a.x, high.y, a.z}, {a.x, high.y, b.z}, {b.x, high.y, b.z}, {b.x, high.y, a.z}};
  };
  const FlatFace outside = ring(low, high);
  const FlatFace inside = ring(cavity_low, cavity_high);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t j = (i + 1) % 4;
    faces.push_back({outside[i], outside[j], inside[j], inside[i]});
  }
  return faces;
}

FlatFaces turned_over(FlatFaces faces) {
  for (FlatFace& face : faces) std::reverse(face.begin(), face.end());
  return faces;
}

FlatFaces moved(const Mat4d& by, FlatFaces faces) {
  for (FlatFace& face : faces)
    for (Vec3d& corner : face) corner = Vec3d(by * Vec4d(corner, 1.0));
  return faces;
}

FlatFaces joined(FlatFaces faces, const FlatFaces& more) {
  faces.insert(faces.end(), more.begin(), more.end());
  return faces;
}

FlatFace Rectangle::face() const {
  return {center - x - y, center + x - y, center + x + y, center - x + y};
}

void OpticalSetup::add(const std::string& body, const FlatFaces& faces, const Matter& matter) {
  FlatBody rounded{body, faces, matter};
  for (FlatFace& face : rounded.faces)
    for (Vec3d& corner : face) corner = Vec3d(Vec3f(corner));
  bodies.push_back(std::move(rounded));
}

}  // namespace abbe::test
