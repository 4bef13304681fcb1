#include "core/features/region_owners.h"

#include <cmath>
#include <limits>

namespace tactus {
namespace {

// A region that covers this part of a contact has swallowed it; one that covers
// less only touches its border.
constexpr double kSwallowed = 0.5;

bool Takes(const KnownContact& contact) {
  return contact.active && contact.host == RegionOwners::kNobody;
}

// True if a region that overlaps contact `a` so much, and `b` so much, is that
// of `a`. One that may have ended has less right to it.
bool HasMore(const KnownContact& a, int overlap_a, const KnownContact& b,
             int overlap_b) {
  if (a.touched != b.touched) return a.touched;
  if (overlap_a != overlap_b) return overlap_a > overlap_b;
  return a.id < b.id;
}

}  // namespace

void RegionOwners::Find(std::span<const RegionPlace> regions,
                        std::span<KnownContact> contacts) {
  for (size_t slot = 0; slot < contacts.size(); ++slot) {
    const KnownContact& contact = contacts[slot];
    if (!Takes(contact)) continue;
    expected_[slot] = contact.rows;
    const auto rows = static_cast<int>(std::lround(contact.velocity.row));
    const auto columns = static_cast<int>(std::lround(contact.velocity.column));
    if (contact.touched && (rows != 0 || columns != 0)) {
      sets_.Move(rows, columns, expected_[slot]);
    }
    grown_[slot] = expected_[slot];
    // A centroid also moves when a region grows or shrinks at one side.
    sets_.Add(contact.rows, grown_[slot]);
    sets_.Grow(grown_[slot]);
  }
  GiveOverlapping(regions, contacts);
  GiveNear(regions, contacts);
  Merge(regions, contacts);
  Part(regions, contacts);
  FindMain(regions, contacts);
}

void RegionOwners::GiveOverlapping(std::span<const RegionPlace> regions,
                                   std::span<const KnownContact> contacts) {
  for (size_t r = 0; r < regions.size(); ++r) {
    owners_[r] = kNobody;
    overlaps_[r] = false;
    int most = 0;
    for (size_t slot = 0; slot < contacts.size(); ++slot) {
      if (!Takes(contacts[slot])) continue;
      // A border that has grown over a neighbour counts less.
      const int overlap = sets_.Overlap(grown_[slot], regions[r].rows) +
                          sets_.Overlap(expected_[slot], regions[r].rows);
      if (overlap == 0) continue;
      if (owners_[r] != kNobody &&
          !HasMore(contacts[slot], overlap, contacts[owners_[r]], most)) {
        continue;
      }
      most = overlap;
      owners_[r] = static_cast<int>(slot);
      overlaps_[r] = true;
    }
  }
}

void RegionOwners::GiveNear(std::span<const RegionPlace> regions,
                            std::span<const KnownContact> contacts) {
  for (size_t r = 0; r < regions.size(); ++r) {
    if (owners_[r] != kNobody) continue;
    TaxelRows near = regions[r].rows;
    for (int i = 0; i < kGap; ++i) sets_.Grow(near);
    int most = 0;
    for (size_t slot = 0; slot < contacts.size(); ++slot) {
      if (!Takes(contacts[slot]) || contacts[slot].lost) continue;
      const int overlap = sets_.Overlap(grown_[slot], near);
      if (overlap <= most) continue;
      most = overlap;
      owners_[r] = static_cast<int>(slot);
    }
  }
}

void RegionOwners::Merge(std::span<const RegionPlace> regions,
                         std::span<KnownContact> contacts) {
  for (size_t slot = 0; slot < contacts.size(); ++slot) {
    KnownContact& contact = contacts[slot];
    if (!Takes(contact) || !contact.touched) continue;
    bool has_region = false;
    int swallower = kNobody;
    for (size_t r = 0; r < regions.size(); ++r) {
      has_region |= owners_[r] == static_cast<int>(slot) && overlaps_[r];
      if (owners_[r] != kNobody && overlaps_[r] &&
          sets_.Overlap(expected_[slot], regions[r].rows) >=
              kSwallowed * sets_.Count(expected_[slot])) {
        swallower = owners_[r];
      }
    }
    if (has_region || swallower == kNobody) continue;
    contact.host = swallower;
    for (KnownContact& guest : contacts) {
      if (guest.active && guest.host == static_cast<int>(slot)) {
        guest.host = swallower;
      }
    }
  }
}

void RegionOwners::Part(std::span<const RegionPlace> regions,
                        std::span<KnownContact> contacts) {
  for (size_t slot = 0; slot < contacts.size(); ++slot) {
    KnownContact& guest = contacts[slot];
    if (!guest.active || guest.host == kNobody) continue;
    const KnownContact& host = contacts[guest.host];
    int parts = 0;
    int nearest = kNobody;
    double best = std::numeric_limits<double>::infinity();
    for (size_t r = 0; r < regions.size(); ++r) {
      if (owners_[r] != guest.host) continue;
      ++parts;
      const double distance = Distance(regions[r].region, guest.centroid) -
                              Distance(regions[r].region, host.centroid);
      if (distance < best) {
        best = distance;
        nearest = static_cast<int>(r);
      }
    }
    if (parts < 2) continue;
    owners_[nearest] = static_cast<int>(slot);
    guest.host = kNobody;
  }
}

void RegionOwners::FindMain(std::span<const RegionPlace> regions,
                            std::span<const KnownContact> contacts) {
  for (size_t slot = 0; slot < contacts.size(); ++slot) {
    int& main = main_[slot];
    main = kNobody;
    for (size_t r = 0; r < regions.size(); ++r) {
      if (owners_[r] != static_cast<int>(slot)) continue;
      main = static_cast<int>(r);
      break;
    }
  }
}

bool RegionOwners::Apart(const TaxelRows& a, const TaxelRows& b) const {
  TaxelRows grown = a;
  for (int i = 0; i <= kGap; ++i) sets_.Grow(grown);
  return !sets_.Overlaps(grown, b);
}

double RegionOwners::Distance(const Region& region,
                              const SkinPoint& point) const {
  return SkinDistance(layout_, {region.centroid_row, region.centroid_column},
                      point);
}

}  // namespace tactus
