#include "core/features/region_owners.h"

#include <cmath>
#include <limits>
#include <utility>

namespace tactus::internal {
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
    TaxelRows& expected = expected_[slot];
    expected = contact.rows;
    const auto rows = static_cast<int>(std::lround(contact.velocity.row));
    const auto columns = static_cast<int>(std::lround(contact.velocity.column));
    const bool moves = contact.touched && (rows != 0 || columns != 0);
    if (moves) sets_.Move(rows, columns, expected);
    grown_[slot] = expected;
    // A centroid also moves when a region grows or shrinks at one side.
    if (moves) sets_.Add(contact.rows, grown_[slot]);
    sets_.Grow(grown_[slot]);
  }
  GiveOverlapping(regions, contacts);
  GiveNear(regions, contacts);
  Merge(regions, contacts);
  Part(regions, contacts);
  FindMain(regions.size());
}

void RegionOwners::GiveOverlapping(std::span<const RegionPlace> regions,
                                   std::span<const KnownContact> contacts) {
  for (size_t r = 0; r < regions.size(); ++r) {
    owners_[r] = kNobody;
    overlaps_[r] = false;
    int most = 0;
    for (size_t slot = 0; slot < contacts.size(); ++slot) {
      if (!Takes(contacts[slot])) continue;
      if (!sets_.Overlaps(grown_[slot], regions[r].rows)) continue;
      overlaps_[r] = true;
      const int owner = std::exchange(owners_[r], static_cast<int>(slot));
      // Nothing is counted for a region that only one contact overlaps.
      if (owner == kNobody) continue;
      if (most == 0) most = Right(owner, regions[r]);
      const int overlap = Right(static_cast<int>(slot), regions[r]);
      if (HasMore(contacts[slot], overlap, contacts[owner], most)) {
        most = overlap;
      } else {
        owners_[r] = owner;
      }
    }
  }
}

int RegionOwners::Right(int slot, const RegionPlace& region) const {
  // A border that has grown over a neighbour counts less.
  return sets_.Overlap(grown_[slot], region.rows) +
         sets_.Overlap(expected_[slot], region.rows);
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
    if (HasRegion(static_cast<int>(slot), regions.size())) continue;
    const double least = kSwallowed * sets_.Count(expected_[slot]);
    int swallower = kNobody;
    for (size_t r = 0; r < regions.size(); ++r) {
      if (owners_[r] != kNobody && overlaps_[r] &&
          sets_.Overlap(expected_[slot], regions[r].rows) >= least) {
        swallower = owners_[r];
      }
    }
    if (swallower == kNobody) continue;
    contact.host = swallower;
    for (KnownContact& guest : contacts) {
      if (guest.active && guest.host == static_cast<int>(slot)) {
        guest.host = swallower;
      }
    }
  }
}

bool RegionOwners::HasRegion(int slot, size_t regions) const {
  for (size_t r = 0; r < regions; ++r) {
    if (owners_[r] == slot && overlaps_[r]) return true;
  }
  return false;
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

void RegionOwners::FindMain(size_t regions) {
  main_.fill(kNobody);
  // The first region comes last.
  for (size_t r = regions; r-- > 0;) {
    if (owners_[r] != kNobody) main_[owners_[r]] = static_cast<int>(r);
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

}  // namespace tactus::internal
