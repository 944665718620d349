#include "support/forward/photons.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace abbe::test {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr int kBatches = 16;         // Whose spread is the standard error.
constexpr int kMostEvents = 100000;  // Of one photon with all its parts.

/// A few faces at one place.
struct FaceSet {
  std::array<std::uint16_t, 6> faces{};
  std::size_t count = 0;

  void add(std::size_t face) {
    if (count == faces.size()) throw std::invalid_argument("too many faces in contact");
    faces[count++] = static_cast<std::uint16_t>(face);
  }
  void add(const FaceSet& more) {
    for (const std::size_t face : more) add(face);
  }
  bool contains(std::size_t face) const { return std::find(begin(), end(), face) != end(); }
  bool empty() const { return count == 0; }
  const std::uint16_t* begin() const { return faces.data(); }
  const std::uint16_t* end() const { return faces.data() + count; }
};

struct Face {
  Vec3d normal{0.0};
  double offset = 0.0;
  std::vector<Vec4d> sides;  ///< Planes through the edges, their normals inwards.
  std::size_t body = 0;
  std::vector<std::uint16_t> contacts;  ///< Faces of other bodies in the same plane.

  bool holds(const Vec3d& p) const {
    return std::all_of(sides.begin(), sides.end(),
                       [&](const Vec4d& side) { return glm::dot(Vec3d(side), p) >= side.w; });
  }
};

struct Photon {
  Vec3d from{0.0}, direction{0.0};
  double power = 0.0;
  std::uint64_t inside = 0;  ///< Bits of the dielectrics that it is in.
  FaceSet left;              ///< All that lie where it starts.
  /// In the thin gap between faces of dielectrics and what is opaque.
  FaceSet gap;
  std::size_t gap_opaque = 0;
};

/// Numbers in [0, 1) from a counter (SplitMix64).
struct Chance {
  std::uint64_t state = 0;

  double draw() {
    state += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
};

Face face_of(const FlatFace& corners, std::size_t body) {
  Face face;
  face.body = body;
  Vec3d middle(0.0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // Newell: twice the area, as a vector.
    face.normal +=
        glm::cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
    middle += corners[i] / static_cast<double>(corners.size());
  }
  face.normal = glm::normalize(face.normal);
  face.offset = glm::dot(face.normal, middle);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d inwards = glm::cross(face.normal, corners[(i + 1) % corners.size()] - corners[i]);
    face.sides.emplace_back(inwards, glm::dot(inwards, corners[i]));
  }
  return face;
}

/// Four units in the last place of a float of the greatest coordinate.
double contact_tolerance(const FlatFace& corners) {
  double most = 0.0;
  for (const Vec3d& c : corners)
    most = std::max({most, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  return 4.0 * most * std::numeric_limits<float>::epsilon();
}

/// Volume by the divergence theorem.
double volume_of(const FlatFaces& faces) {
  double six = 0.0;
  for (const FlatFace& face : faces)
    for (std::size_t i = 2; i < face.size(); ++i)
      six += glm::dot(face[0], glm::cross(face[i - 1], face[i]));
  return six / 6.0;
}

/// A setup made ready for one wavelength.
struct Geometry {
  std::vector<Face> faces;
  std::vector<double> n;          ///< Of each body.
  std::vector<std::size_t> rank;  ///< Bodies in the order in which they own space.
  double reach = 0.0;             ///< Nothing is further from the origin.

  Geometry(const OpticalSetup& setup, double wavelength_nm) {
    if (setup.bodies.size() > 64) throw std::invalid_argument("too many bodies");
    std::vector<double> tolerance;
    for (std::size_t b = 0; b < setup.bodies.size(); ++b) {
      const FlatBody& body = setup.bodies[b];
      for (const FlatFace& corners : body.faces) {
        faces.push_back(face_of(corners, b));
        tolerance.push_back(contact_tolerance(corners));
        for (const Vec3d& c : corners) reach = std::max(reach, glm::length(c));
      }
      const auto* glass = std::get_if<Dielectric>(&body.matter);
      n.push_back(glass != nullptr ? glass->index.at(wavelength_nm) : 1.0);
      if (glass != nullptr) rank.push_back(b);
    }
    const auto order = [&](std::size_t b) {
      return std::pair(-std::get<Dielectric>(setup.bodies[b].matter).priority,
                       volume_of(setup.bodies[b].faces));
    };
    std::sort(rank.begin(), rank.end(),
              [&](std::size_t a, std::size_t b) { return order(a) < order(b); });
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (std::size_t g = 0; g < faces.size(); ++g) {
        if (faces[f].body == faces[g].body) continue;
        const double facing = glm::dot(faces[f].normal, faces[g].normal);
        if (std::abs(facing) > 1.0 - 1e-9 &&
            std::abs(faces[f].offset - std::copysign(1.0, facing) * faces[g].offset) <=
                std::max(tolerance[f], tolerance[g]))
          faces[f].contacts.push_back(static_cast<std::uint16_t>(g));
      }
    }
  }

  /// The dielectric that a place belongs to, if it is in any.
  std::optional<std::size_t> medium(std::uint64_t inside) const {
    for (const std::size_t body : rank)
      if ((inside >> body & 1u) != 0) return body;
    return std::nullopt;
  }
  double index(std::uint64_t inside) const {
    const auto body = medium(inside);
    return body ? n[*body] : 1.0;
  }
};

class Follower {
 public:
  Follower(const OpticalSetup& setup, const Geometry& geometry, double split_share)
      : setup_(setup), geometry_(geometry), split_share_(split_share) {
    result.on_body.assign(setup.bodies.size(), 0.0);
    result.irradiance.assign(static_cast<std::size_t>(setup.cells.x * setup.cells.y), 0.0);
  }

  void follow(const Photon& photon, const Chance& chance) {
    chance_ = chance;
    split_power_ = split_share_ * photon.power;
    waiting_.assign(1, photon);
    for (int events = 0; !waiting_.empty(); ++events) {
      const Photon next = waiting_.back();
      waiting_.pop_back();
      if (events < kMostEvents)
        step(next);
      else
        result.lost += next.power;
    }
  }

  ForwardResult result;

 private:
  const Face& face(std::size_t f) const { return geometry_.faces[f]; }
  bool is_glass(std::size_t body) const {
    return std::holds_alternative<Dielectric>(setup_.bodies[body].matter);
  }

  void step(Photon photon) {
    if (!photon.gap.empty()) {
      step_in_gap(photon);
      return;
    }
    double t = kNever;
    std::size_t first = 0;
    for (std::size_t f = 0; f < geometry_.faces.size(); ++f) {
      if (photon.left.contains(f)) continue;
      const double d = distance(photon, f);
      if (d < t && face(f).holds(photon.from + d * photon.direction)) {
        t = d;
        first = f;
      }
    }
    if (t == kNever) {
      result.escaped += photon.power;
      return;
    }
    if (const auto medium = geometry_.medium(photon.inside)) {
      const double a = std::get<Dielectric>(setup_.bodies[*medium].matter).absorption_per_m;
      const double kept = photon.power * std::exp(-a * t);
      result.absorbed += photon.power - kept;
      photon.power = kept;
    }
    photon.from += t * photon.direction;
    meet(photon, first);
  }

  double distance(const Photon& photon, std::size_t f) const {
    const double slope = glm::dot(face(f).normal, photon.direction);
    const double t = (face(f).offset - glm::dot(face(f).normal, photon.from)) / slope;
    return t > -1e-12 ? t : kNever;
  }

  /// What lies at one place, in the order in which the photon meets it.
  void meet(Photon photon, std::size_t first) {
    FaceSet leaving, entering;
    std::optional<std::size_t> opaque;
    photon.left = {};
    const auto sort = [&](std::size_t f) {
      photon.left.add(f);
      if (!is_glass(face(f).body))
        opaque = f;
      else if (glm::dot(face(f).normal, photon.direction) > 0.0)
        leaving.add(f);
      else
        entering.add(f);
    };
    sort(first);
    for (const std::size_t f : face(first).contacts)
      if (face(f).holds(photon.from)) sort(f);
    if (!opaque) {
      leaving.add(entering);
      cross(photon, leaving, std::nullopt);
    } else if (!leaving.empty()) {
      cross(photon, leaving, opaque);
    } else {
      end_at(photon, *opaque);
    }
  }

  void step_in_gap(const Photon& photon) {
    // The dielectric's normals point into the gap.
    if (glm::dot(face(*photon.gap.begin()).normal, photon.direction) > 0.0)
      end_at(photon, photon.gap_opaque);
    else
      cross(photon, photon.gap, std::nullopt);
  }

  /// Through faces of dielectrics, into the gap before something opaque or into a medium.
  void cross(const Photon& photon, const FaceSet& faces, std::optional<std::size_t> opaque) {
    Photon through = photon;
    for (const std::size_t f : faces) {
      const std::uint64_t bit = std::uint64_t{1} << face(f).body;
      const bool is_leaving = glm::dot(face(f).normal, photon.direction) > 0.0;
      if (is_leaving != ((through.inside & bit) != 0)) {
        result.lost += photon.power;
        return;
      }
      through.inside ^= bit;
    }
    Photon back = photon;
    if (opaque) {
      through.gap = faces;
      through.gap_opaque = *opaque;
    } else {
      through.gap = {};
    }
    const double n1 = geometry_.index(photon.inside);
    const double n2 = geometry_.index(through.inside);
    Vec3d normal = face(*faces.begin()).normal;
    if (glm::dot(normal, photon.direction) > 0.0) normal = -normal;
    const double cos_i = -glm::dot(normal, photon.direction);
    const double share = n1 == n2 ? 0.0 : interface_reflectance(cos_i, n1, n2);
    back.direction = glm::normalize(photon.direction + 2.0 * cos_i * normal);
    const double eta = n1 / n2;
    const double cos_t = std::sqrt(std::max(0.0, 1.0 - eta * eta * (1.0 - cos_i * cos_i)));
    through.direction = glm::normalize(eta * photon.direction + (eta * cos_i - cos_t) * normal);
    send_on(through, back, share);
  }

  void send_on(Photon through, Photon back, double share) {
    if (share == 0.0 || share == 1.0) {
      waiting_.push_back(share == 0.0 ? through : back);
    } else if (through.power < split_power_) {
      waiting_.push_back(chance_.draw() < share ? back : through);
    } else {
      back.power *= share;
      through.power -= back.power;
      waiting_.push_back(back);
      waiting_.push_back(through);
    }
  }

  void end_at(Photon photon, std::size_t f) {
    const std::size_t body = face(f).body;
    const auto* mirror = std::get_if<Mirror>(&setup_.bodies[body].matter);
    if (mirror == nullptr) {
      result.on_body[body] += photon.power;
      land(photon);
      return;
    }
    Vec3d normal = face(f).normal;
    if (glm::dot(normal, photon.direction) > 0.0) normal = -normal;
    const double cos_i = -glm::dot(normal, photon.direction);
    if (mirror->index) {
      const double kept = photon.power * interface_reflectance(
                                             cos_i, geometry_.index(photon.inside), *mirror->index);
      result.on_body[body] += photon.power - kept;
      photon.power = kept;
    }
    photon.direction = glm::normalize(photon.direction + 2.0 * cos_i * normal);
    waiting_.push_back(photon);
  }

  void land(const Photon& photon) {
    const Rectangle& receiver = setup_.receiver;
    const Vec3d at = photon.from - receiver.center;
    // The wall it lies on may have been rounded to single precision.
    const double near = 1e-6 * (glm::length(receiver.x) + glm::length(receiver.center));
    if (glm::dot(photon.direction, receiver.normal()) >= 0.0 ||
        std::abs(glm::dot(at, receiver.normal())) > near)
      return;
    const double x = 0.5 + 0.5 * glm::dot(at, receiver.x) / glm::dot(receiver.x, receiver.x);
    const double y = 0.5 - 0.5 * glm::dot(at, receiver.y) / glm::dot(receiver.y, receiver.y);
    if (!(x >= 0.0 && y >= 0.0 && x < 1.0 && y < 1.0)) return;
    const int column = static_cast<int>(x * setup_.cells.x);
    const int row = static_cast<int>(y * setup_.cells.y);
    result.irradiance[static_cast<std::size_t>(row * setup_.cells.x + column)] += photon.power;
  }

  const OpticalSetup& setup_;
  const Geometry& geometry_;
  double split_share_ = 0.0, split_power_ = 0.0;
  std::vector<Photon> waiting_;
  Chance chance_;
};

/// A photon through a place of the rectangle aimed at, of power for one of `photons`.
Photon aimed(const OpticalSetup& setup, const Vec3d& at, double reach, double photons) {
  const SetupLamp& lamp = setup.lamp;
  const double area = setup.aim.area() / photons;
  Photon photon;
  if (lamp.kind == LampKind::Directional) {
    photon.direction = glm::normalize(lamp.direction);
    photon.from = at - (2.0 * reach + glm::length(at)) * photon.direction;
    photon.power = area * std::abs(glm::dot(setup.aim.normal(), photon.direction));
    return photon;
  }
  const double r = glm::distance(at, lamp.position);
  photon.from = lamp.position;
  photon.direction = (at - lamp.position) / r;
  photon.power = area * std::abs(glm::dot(setup.aim.normal(), photon.direction)) / (r * r);
  if (lamp.kind == LampKind::Spot) {
    // KHR_lights_punctual's cone.
    const double outer = std::cos(lamp.outer_cone_rad);
    const double cosine = glm::dot(photon.direction, glm::normalize(lamp.direction));
    const double ramp = std::clamp(
        (cosine - outer) / std::max(0.001, std::cos(lamp.inner_cone_rad) - outer), 0.0, 1.0);
    photon.power *= ramp * ramp;
  }
  return photon;
}

void send_batch(Follower& follower, const OpticalSetup& setup, double reach,
                const PhotonOptions& options, std::uint64_t batch) {
  Chance shift{options.seed * 0x100000001b3ull + batch};
  const double shift_x = shift.draw();
  const double shift_y = shift.draw();
  const std::uint64_t photons = options.photons.value_or(setup.photons) / kBatches;
  for (std::uint64_t i = 0; i < photons; ++i) {
    // Roberts' sequence, powers of the inverse plastic number, shifted for each batch.
    const double u = std::fmod(shift_x + static_cast<double>(i) * 0.7548776662466927, 1.0);
    const double v = std::fmod(shift_y + static_cast<double>(i) * 0.5698402909980532, 1.0);
    const Vec3d at =
        setup.aim.center + (2.0 * u - 1.0) * setup.aim.x + (2.0 * v - 1.0) * setup.aim.y;
    const Photon photon = aimed(setup, at, reach, static_cast<double>(photons));
    follower.result.sent += photon.power;
    follower.follow(photon, {shift.state + (i << 20)});
  }
}

}  // namespace

double interface_reflectance(double cos_i, double n1, std::complex<double> n2) {
  const std::complex<double> m = n2 / n1;
  const double sin2 = 1.0 - cos_i * cos_i;
  if (m.imag() == 0.0 && sin2 >= m.real() * m.real()) return 1.0;
  // m cos_t; an inhomogeneous wave where the second medium absorbs.
  const std::complex<double> q = std::sqrt(m * m - sin2);
  const double s = std::norm((cos_i - q) / (cos_i + q));
  const double p = std::norm((m * m * cos_i - q) / (m * m * cos_i + q));
  return 0.5 * (s + p);
}

ForwardResult follow_photons(const OpticalSetup& setup, const PhotonOptions& options) {
  const Geometry geometry(setup, options.wavelength_nm);
  std::vector<Follower> batches(kBatches, Follower(setup, geometry, options.split_share));
  tbb::parallel_for(0, kBatches, [&](int b) {
    send_batch(batches[static_cast<std::size_t>(b)], setup, geometry.reach, options,
               static_cast<std::uint64_t>(b));
  });
  ForwardResult all = Follower(setup, geometry, options.split_share).result;
  const std::size_t cells = all.irradiance.size();
  const double cell_area = setup.receiver.area() / static_cast<double>(cells);
  all.standard_error.assign(cells, 0.0);
  for (const Follower& follower : batches) {
    const ForwardResult& batch = follower.result;
    for (std::size_t c = 0; c < cells; ++c) {
      const double e = batch.irradiance[c] / (cell_area * setup.unit);
      all.irradiance[c] += e / kBatches;
      all.standard_error[c] += e * e / kBatches;
    }
    for (std::size_t b = 0; b < all.on_body.size(); ++b)
      all.on_body[b] += batch.on_body[b] / kBatches;
    all.sent += batch.sent / kBatches;
    all.absorbed += batch.absorbed / kBatches;
    all.escaped += batch.escaped / kBatches;
    all.lost += batch.lost / kBatches;
  }
  for (std::size_t c = 0; c < cells; ++c) {
    const double variance = all.standard_error[c] - all.irradiance[c] * all.irradiance[c];
    all.standard_error[c] = std::sqrt(std::max(0.0, variance) / (kBatches - 1));
  }
  return all;
}

}  // namespace abbe::test
