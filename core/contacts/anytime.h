// File: anytime.h
//
// The times since onset at which answers are calibrated and evaluated, and the
// walk of a classifier through a contact that stops at each of them.
//
//   ContactClassifier classifier(model, {});
//   WalkContact(contact, classifier, [&](int time) {
//     accuracy[kAnytimeSeconds[time]] = classifier.probability()[label];
//   });
//
// The classifier stays the caller's. Thread-safe: free functions without state.
#pragma once

#include <array>
#include <cstdint>

#include "absl/functional/function_ref.h"
#include "core/classify/contact_classifier.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

inline constexpr int kAnytimeCount = 6;
// Seconds since onset, increasing.
inline constexpr std::array<double, kAnytimeCount> kAnytimeSeconds = {
    0.1, 0.25, 0.5, 1.2, 2.5, 5.0};

// The same times in frames at `rate` frames per second, each at least 1.
// Low rates give equal entries.
std::array<uint64_t, kAnytimeCount> AnytimeFrames(double rate);

// Steps `classifier`, which must be new or reset, through all frames of
// `contact`. Calls `visit(frame)`, frame from 0, after each of them.
void WalkFrames(const LabelledContact& contact, ContactClassifier& classifier,
                absl::FunctionRef<void(size_t frame)> visit);

// Steps the classifier in the same way. Calls `visit(i)` for every i below
// kAnytimeCount, in order: after the frame at which time i is reached, or after
// the last frame of a contact that ends before time i. `each`, if it is given,
// is called after every frame, before the times that the frame reaches.
void WalkContact(
    const LabelledContact& contact, ContactClassifier& classifier,
    absl::FunctionRef<void(int time)> visit,
    absl::FunctionRef<void(size_t frame)> each = [](size_t) {});

}  // namespace tactus::internal
