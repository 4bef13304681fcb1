// File: trial_driver.h
//
// TrialDriver: plays labelled trials with taxels frame by frame. What the
// trials are is up to the class derived from it: ReplayDriver, SimDriver.
// All trials of one driver must be alike (layout, taxel type, scale, rate,
// poses). Their capture times follow one another on one clock. A driver
// without trials configures to an empty layout and is at its end at once.
//
// Several drivers may share the work: driver `shard` of `shards` plays every
// shards-th trial.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include "client/drivers/labelled_driver.h"
#include "core/data/trial.h"

namespace tactus::internal::client {

struct Shard {
  size_t shard = 0;
  size_t shards = 1;
};

class TrialDriver : public LabelledDriver {
 public:
  const Trial& trial() const override { return trial_; }
  size_t trial_index() const override { return index_; }

 protected:
  // `count` is the number of trials in the whole list. `layout` is the skin of
  // trials whose layout class has its name; other classes must be presets.
  TrialDriver(const Shard& shard, size_t count,
              std::optional<SkinLayout> layout = std::nullopt)
      : layout_(std::move(layout)), shard_(shard), count_(count) {}

  void set_count(size_t count) { count_ = count; }
  // Trial `index` of the whole list, 0 to count - 1; with taxels.
  virtual absl::StatusOr<Trial> MakeTrial(size_t index) = 0;

  // Makes the first trial, which sets what the others must be like.
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override;

 private:
  absl::StatusOr<SkinInfo> InfoOf(const Trial& trial) const;
  void FillFrame(SkinFrame& frame);

  const std::optional<SkinLayout> layout_;
  const Shard shard_;
  size_t count_;
  size_t index_ = 0;
  Trial trial_;
  SkinInfo info_;
  // Capture time of trial_'s first frame.
  int64_t start_ns_ = 0;
  // Next frame of trial_.
  size_t frame_ = 0;
  // trial_ was not played to its end.
  bool playing_ = false;
};

}  // namespace tactus::internal::client
