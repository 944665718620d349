/// Vectors and matrices of the renderer: GLM under short names.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace abbe {

using Vec2f = glm::vec2;
using Vec3f = glm::vec3;
using Vec4f = glm::vec4;
using Vec2d = glm::dvec2;
using Vec3d = glm::dvec3;
using Vec4d = glm::dvec4;
using Vec2i = glm::ivec2;
using Mat3d = glm::dmat3;
using Mat4d = glm::dmat4;

/// Two unit vectors that make a right-handed orthonormal basis with the unit vector n.
/// Source: Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017.
struct Basis {
  Vec3f tangent, bitangent, normal;
  explicit Basis(const Vec3f& n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }
  Vec3f to_world(const Vec3f& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
  Vec3f to_local(const Vec3f& v) const {
    return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)};
  }
};

}  // namespace abbe
