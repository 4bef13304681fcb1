#include "core/sim/experiments/link_path.h"

#include <algorithm>
#include <iterator>

#include "core/sim/skin/block_filter.h"

namespace tactus::internal {
namespace {

// Metres along the normal at `frame`, from the place of the touch. Beyond the
// simulation the arm stays where it was.
double MotionAt(const PlacedContact& placed, size_t frame) {
  const SimulatedContact& contact = *placed.contact;
  if (frame < placed.begin_frame) {
    const double before_s =
        static_cast<double>(placed.begin_frame - 1 - frame) / kSkinRateHz;
    return ApproachPosition(contact.spec.approach_s, before_s,
                            SceneOf(contact.spec));
  }
  const auto& samples = contact.signals.samples;
  const size_t sample =
      std::min(frame - placed.begin_frame, samples.size() - 1);
  return samples[sample][static_cast<int>(Feature::kMotion)];
}

// 0 to 1, with no speed at the ends.
double SmoothStep(double x) { return x * x * (3 - 2 * x); }

}  // namespace

LinkPath::LinkPath(const SkinLayout& layout, const PlacedContact& first)
    : layout_(layout) {
  legs_.push_back(
      {.contact = &first, .normal = LinkNormal(layout, first.centre)});
}

Eigen::Vector3d LinkPath::Leg::PositionAt(size_t frame) const {
  if (contact == nullptr) return origin;
  return origin + normal * MotionAt(*contact, frame);
}

void LinkPath::Add(Leg leg) {
  const size_t middle = leg.turn_begin + leg.turn_frames / 2;
  leg.origin = legs_.back().PositionAt(middle) - leg.PositionAt(middle);
  legs_.push_back(leg);
}

void LinkPath::Follow(size_t frame, size_t turn_frames,
                      const PlacedContact& next) {
  Add({.contact = &next,
       .normal = LinkNormal(layout_, next.centre),
       .turn_begin = frame,
       .turn_frames = turn_frames});
}

void LinkPath::Rest(size_t frame, size_t turn_frames) {
  Add({.turn_begin = frame, .turn_frames = turn_frames});
}

std::vector<LinkStep> LinkPath::Steps(size_t frames) const {
  std::vector<LinkStep> steps;
  steps.reserve(frames);
  auto leg = legs_.begin();
  for (size_t i = 0; i < frames; ++i) {
    const auto next = std::next(leg);
    if (next == legs_.end() || i <= next->turn_begin) {
      steps.push_back({leg->PositionAt(i), 1});
      continue;
    }
    const double share = SmoothStep(static_cast<double>(i - next->turn_begin) /
                                    static_cast<double>(next->turn_frames));
    steps.push_back(
        {(1 - share) * leg->PositionAt(i) + share * next->PositionAt(i), 1});
    if (i == next->turn_begin + next->turn_frames) leg = next;
  }
  return steps;
}

}  // namespace tactus::internal
