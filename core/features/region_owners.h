// File: region_owners.h
//
// Which contact each region of a frame belongs to: by overlap with where the
// contacts were and how they moved.
//
//   RegionOwners owners(layout);
//   owners.Find(regions, contacts);
//   owners.owner(0);  // the slot of the contact of region 0, or kNobody
//
// Nothing allocates. Not thread-safe; one per stream.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/limits.h"
#include "core/features/segmenter.h"
#include "core/features/taxel_rows.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus::internal {

// What is known of a contact before a frame.
struct KnownContact {
  // False for a free slot.
  bool active = false;
  uint64_t id = 0;
  // It was felt in the frame before.
  bool touched = false;
  // It was not felt for so long that it comes back at its place only.
  bool lost = false;
  // The slot of the contact that it is merged into, or RegionOwners::kNobody.
  int host = -1;
  // Where it is sought: its taxels in the frame before or, if it was not felt
  // then, all that it had of late.
  TaxelRows rows = {};
  // The centroid of its region when it touched last, and how far that moves in
  // a frame.
  SkinPoint centroid = {};
  SkinPoint velocity = {};
};

class RegionOwners {
 public:
  static constexpr int kNobody = -1;
  // Regions that are looked at.
  static constexpr int kMaxRegions = 16;
  // Taxels between a contact and what is no part of it.
  static constexpr int kGap = 2;

  explicit RegionOwners(const SkinLayout& layout)
      : layout_(layout), sets_(layout) {}

  // `regions` are at most kMaxRegions, by falling size; `contacts` at most
  // limits::kMaxContacts. Changes `host` where contacts merge or part.
  void Find(std::span<const RegionPlace> regions,
            std::span<KnownContact> contacts);

  // The results of the last Find():

  int owner(int region) const { return owners_[region]; }
  // The largest region of a contact; kNobody if it has none.
  int main_region(int slot) const { return main_[slot]; }

  // Gives a region to a contact that begins with it.
  void Give(int region, int slot) { owners_[region] = slot; }

  // True if there are more than kGap taxels between them.
  bool Apart(const TaxelRows& a, const TaxelRows& b) const;

 private:
  void GiveOverlapping(std::span<const RegionPlace> regions,
                       std::span<const KnownContact> contacts);
  void GiveNear(std::span<const RegionPlace> regions,
                std::span<const KnownContact> contacts);
  void Merge(std::span<const RegionPlace> regions,
             std::span<KnownContact> contacts);
  void Part(std::span<const RegionPlace> regions,
            std::span<KnownContact> contacts);
  void FindMain(size_t regions);
  // How much of a region a contact overlaps, with its grown border.
  int Right(int slot, const RegionPlace& region) const;
  // True if a contact overlaps a region that is given to it.
  bool HasRegion(int slot, size_t regions) const;
  double Distance(const Region& region, const SkinPoint& point) const;

  SkinLayout layout_;
  TaxelSets sets_;
  std::array<int, kMaxRegions> owners_ = {};
  // False if a region is only near its owner.
  std::array<bool, kMaxRegions> overlaps_ = {};
  std::array<int, limits::kMaxContacts> main_ = {};
  // Where contacts are expected, before and after growing.
  std::array<TaxelRows, limits::kMaxContacts> expected_ = {};
  std::array<TaxelRows, limits::kMaxContacts> grown_ = {};
};

}  // namespace tactus::internal
