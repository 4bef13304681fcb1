#include "core/contacts/anytime.h"

#include "core/features/contact_time.h"

namespace tactus::internal {

std::array<uint64_t, kAnytimeCount> AnytimeFrames(double rate) {
  std::array<uint64_t, kAnytimeCount> frames;
  for (int i = 0; i < kAnytimeCount; ++i) {
    frames[i] = FramesIn(kAnytimeSeconds[i], rate);
  }
  return frames;
}

void WalkFrames(const LabelledContact& contact, ContactClassifier& classifier,
                absl::FunctionRef<void(size_t frame)> visit) {
  for (size_t t = 0; t < contact.frames.size(); ++t) {
    classifier.StepOrHold(contact.frames[t], /*missing_before=*/0);
    visit(t);
  }
}

void WalkContact(const LabelledContact& contact, ContactClassifier& classifier,
                 absl::FunctionRef<void(int time)> visit,
                 absl::FunctionRef<void(size_t frame)> each) {
  const auto due = AnytimeFrames(contact.sample_rate_hz);
  int next = 0;
  WalkFrames(contact, classifier, [&](size_t frame) {
    each(frame);
    for (; next < kAnytimeCount && classifier.frames() >= due[next]; ++next) {
      visit(next);
    }
  });
  for (; next < kAnytimeCount; ++next) visit(next);
}

}  // namespace tactus::internal
