#include "tools/fakeskin/sim_touches.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace tactus::internal::client {
namespace {

// Frame of a trial at a time since its begin, or the last.
size_t FrameAt(const Trial& trial, int64_t since_ns) {
  const double frame =
      static_cast<double>(since_ns) / 1e9 * trial.sample_rate_hz;
  // A board reads what was true a moment ago; a stamp a little early is not the
  // frame before.
  return std::min(static_cast<size_t>(std::max(0.0, std::round(frame))),
                  trial.time.size() - 1);
}

}  // namespace

SimTouches::SimTouches(const SimTouchesOptions& options)
    : options_(options),
      driver_({.seed = options.seed, .centre = options.centre},
              options.contacts, {}) {
  patch_.boards = {{.address = 1}, {.address = 2}};
  patch_.layout = *LayoutPreset("cody-forearm");
  patch_.cells.resize(2 * icub::kBoardValues);
  std::iota(patch_.cells.begin(), patch_.cells.end(), 0);
}

bool SimTouches::MakeNext() {
  if (made_ == options_.contacts) return false;
  if (made_ == 0) {
    if (!driver_.Configure().ok() || !driver_.Activate().ok()) return false;
  } else {
    // To the end of the trial before, and to the first frame of the next.
    SkinFrame frame;
    while (true) {
      const auto result = driver_.Read(frame);
      if (!result.ok() || *result == ReadResult::kEndOfData) return false;
      if (*result != ReadResult::kEndOfTrial) continue;
      const auto next = driver_.Read(frame);
      if (!next.ok() || *next != ReadResult::kFrame) return false;
      break;
    }
  }
  ++made_;
  Touch touch;
  touch.trial = driver_.trial();
  touch.begin_ns = touches_.empty()
                       ? options_.begin_ns
                       : touches_.back().end_ns + options_.pause_ns;
  touch.end_ns = touch.begin_ns +
                 std::llround(static_cast<double>(touch.trial.time.size()) /
                              touch.trial.sample_rate_hz * 1e9);
  if (made_ == options_.contacts) end_ns_ = touch.end_ns + options_.pause_ns;
  touches_.push_back(std::move(touch));
  return true;
}

void SimTouches::MakeAll() {
  keep_all_ = true;
  while (MakeNext()) continue;
}

void SimTouches::BeginAt(int64_t begin_ns) {
  if (touches_.empty()) return;
  const int64_t shift_ns = begin_ns - touches_[0].begin_ns;
  for (Touch& touch : touches_) {
    touch.begin_ns += shift_ns;
    touch.end_ns += shift_ns;
  }
  if (end_ns_) *end_ns_ += shift_ns;
}

const SimTouches::Touch* SimTouches::At(int64_t time_ns) {
  while (touches_.empty() ||
         time_ns >= touches_.back().end_ns + options_.pause_ns) {
    if (!MakeNext()) break;
    // Only labels are asked for contacts long ago.
    if (touches_.size() > 2 && !keep_all_) {
      touches_[touches_.size() - 3].trial.taxels = {};
    }
  }
  for (auto touch = touches_.rbegin(); touch != touches_.rend(); ++touch) {
    if (touch->begin_ns <= time_ns) return &*touch;
  }
  return nullptr;
}

void SimTouches::ForcesAt(int64_t time_ns, size_t first,
                          std::span<double> newtons) {
  const Touch* touch = At(time_ns);
  if (touch == nullptr || time_ns >= touch->end_ns ||
      touch->trial.taxels.empty()) {
    return;
  }
  const TaxelSeries& taxels = touch->trial.taxels;
  const size_t begin = FrameAt(touch->trial, time_ns - touch->begin_ns) *
                           static_cast<size_t>(taxels.rows) * taxels.columns +
                       first;
  for (size_t i = 0; i < newtons.size(); ++i) {
    newtons[i] = taxels.u16[begin + i] * taxels.scale;
  }
}

IcubBoards::Source SimTouches::Source() {
  return [this](int64_t time_ns, size_t board, std::span<double> counts) {
    ForcesAt(time_ns, board * icub::kBoardValues, counts);
    for (double& count : counts) count /= options_.newton_per_count;
  };
}

Pose SimTouches::PoseAt(int64_t time_ns) {
  const Touch* touch = At(time_ns);
  if (touch == nullptr) return {};
  return touch->trial.poses[FrameAt(touch->trial, time_ns - touch->begin_ns)];
}

size_t SimTouches::Begun(int64_t time_ns) {
  const Touch* touch = At(time_ns);
  return touch == nullptr ? 0 : static_cast<size_t>(touch - &touches_[0]) + 1;
}

std::string SimTouches::LabelAt(int64_t time_ns) {
  const Touch* touch = At(time_ns);
  return touch == nullptr ? "" : touch->trial.label;
}

}  // namespace tactus::internal::client
