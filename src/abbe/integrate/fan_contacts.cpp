#include "abbe/integrate/fan_contacts.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "abbe/integrate/surface/contact.h"

namespace abbe {
namespace {

void set_hit(HitPacket& packet, int lane, const Hit& hit) {
  packet.t[lane] = hit.t;
  packet.u[lane] = hit.u;
  packet.v[lane] = hit.v;
  packet.primitive[lane] = hit.primitive;
}

}  // namespace

void settle_contacts(const World& world, const FanList& list, std::size_t first, std::size_t last,
                     IntegratorScratch::Buffers& b) {
  const auto stride = static_cast<std::size_t>(world.lanes.lane_stride());
  ContactFinder finder(world);
  b.contacts.assign(1, {});
  b.hit_contacts.assign(b.hits.size(), 0);
  b.lane_contacts.assign(kPacketLanes * b.packet_hits.size(), 0);
  for (std::size_t i = first; i < last; ++i) {
    const Fan& fan = list.fans[i];
    const std::size_t first_of_fan = b.contacts.size();
    const auto settle = [&](const Ray& ray, Hit& hit) -> std::uint32_t {
      std::optional<Contact> contact;
      if (fan.departure.is_crowded()) {
        contact = finder.leave(ray, fan.departure, hit);
      } else if (hit.is_hit() && world.touching_of(hit.primitive)
                                     .holds(ray.origin + hit.t * ray.direction, hit.t)) {
        contact = finder.meet(ray, hit);
      }
      if (!contact) return 0;
      // Lanes with the same go on together.
      std::size_t number = first_of_fan;
      while (number < b.contacts.size() && !b.contacts[number].is_like(*contact)) ++number;
      if (number == b.contacts.size()) b.contacts.push_back(*contact);
      Contact& kept = b.contacts[number];
      kept.spread_m = std::max(kept.spread_m, contact->spread_m);
      kept.reach_m = std::max(kept.reach_m, contact->reach_m);
      return static_cast<std::uint32_t>(number);
    };
    const std::size_t query = b.first_query[i - first];
    if (!fan.spread) {
      b.hit_contacts[query] = settle({fan.origin, kInfinity, fan.direction}, b.hits[query]);
      continue;
    }
    const float* rays = list.pool.data() + fan.data + stride;
    const auto at = [&](int array, int lane) {
      return rays[static_cast<std::size_t>(array) * stride + static_cast<std::size_t>(lane)];
    };
    for (int lane = 0; lane < world.lanes.lane_count(); ++lane) {
      if (!fan.lanes.test(lane)) continue;
      HitPacket& packet = b.packet_hits[query + static_cast<std::size_t>(lane / kPacketLanes)];
      const int place = lane % kPacketLanes;
      Hit hit = hit_of(packet, place);
      b.lane_contacts[kPacketLanes * query + static_cast<std::size_t>(lane)] =
          settle({{at(0, lane), at(1, lane), at(2, lane)},
                  kInfinity,
                  {at(3, lane), at(4, lane), at(5, lane)}},
                 hit);
      set_hit(packet, place, hit);
    }
  }
}

}  // namespace abbe
