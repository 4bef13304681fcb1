// File: contact_summary.h
//
// What the contacts of a trial file look like, in numbers: the values before
// the onset, and force, area, motion and losses of touch after it.
//
//   ContactSummary summary;
//   for (const Trial& trial : trials) {
//     TACTUS_RETURN_IF_ERROR(summary.Add(trial, layout));
//   }
//   std::cout << JsonText(summary.ToJson(), 2);
//
// Keeps a few numbers per trial, and a bounded number of idle values. Not
// thread-safe.
#pragma once

#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/data/trial.h"
#include "core/skin/layout.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

class ContactSummary {
 public:
  // Takes a trial with taxels, whose skin is `layout`.
  absl::Status Add(const Trial& trial, const SkinLayout& layout);

  // Null where there is nothing to tell.
  Json ToJson() const;

 private:
  void CountTouched(std::span<const float> taxels, const SkinLayout& layout);
  void KeepIdle(std::span<const float> taxels, const SkinLayout& layout);

  int trials_ = 0;
  int felt_ = 0;
  // Frames of all trials, and per taxel those in which it was touched.
  size_t frames_ = 0;
  std::vector<size_t> touched_;
  std::vector<double> idle_;
  size_t idle_frames_ = 0;
  // One number per felt trial.
  std::vector<double> onset_s_;
  std::vector<double> contact_s_;
  std::vector<double> peak_;
  std::vector<double> taxels_;
  std::vector<double> regions_;
  std::vector<double> motion_mm_;
  std::vector<double> loss_s_;
  // Mean change of a taxel from a frame to the next, over the mean value. Above
  // a half, frames or taxels are probably in a wrong order.
  std::vector<double> change_;
};

}  // namespace tactus::internal::client
