// File: history_sample.h
//
// What learners that see all taxels are fitted to: contacts, each with three
// parts, so that a model answers at any time.
//
//   for (const double part : kHistoryParts) {
//     for (const size_t end = EndOf(part, frames); t < end; ++t) step(t);
//   }
//
// Plain data. Thread-safe: free functions without state.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/ridge/frame_views.h"

namespace tactus::internal {

// A contact as the fits take it.
struct HistorySample {
  // The touched taxels of each touched frame, and its components; at least one
  // frame.
  std::vector<std::span<const TaxelLoad>> frames;
  int label = 0;
  // Contacts of one group are left out together when something is chosen.
  int group = 0;
};

// The parts of a contact that count: its first quarter, its first half, all.
inline constexpr std::array<double, 3> kHistoryParts = {0.25, 0.5, 1};

// The frame, from 1, that ends a part of a contact.
size_t EndOf(double part, size_t frames);

// The views of frames of this shape. Each view's scale is one over the root of
// the mean square of its channels of taxels that are not 0, and an auxiliary
// component's scale is one over that of its values.
FrameViews FitViews(std::span<const HistorySample> samples,
                    const TaxelShape& shape);

}  // namespace tactus::internal
