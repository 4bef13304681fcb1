#include "core/contacts/anytime.h"

#include <algorithm>
#include <cmath>

namespace tactus {

std::array<uint64_t, kAnytimeCount> AnytimeFrames(double rate) {
  std::array<uint64_t, kAnytimeCount> frames;
  for (int i = 0; i < kAnytimeCount; ++i) {
    frames[i] = static_cast<uint64_t>(
        std::max(1.0, std::round(kAnytimeSeconds[i] * rate)));
  }
  return frames;
}

void WalkContact(const LabelledContact& contact, ContactClassifier& classifier,
                 absl::FunctionRef<void(int time)> visit) {
  const auto due = AnytimeFrames(contact.sample_rate_hz);
  int next = 0;
  for (const ContactFrame& frame : contact.frames) {
    classifier.StepOrHold(frame, /*missing_before=*/0);
    for (; next < kAnytimeCount && classifier.frames() >= due[next]; ++next) {
      visit(next);
    }
  }
  for (; next < kAnytimeCount; ++next) visit(next);
}

}  // namespace tactus
