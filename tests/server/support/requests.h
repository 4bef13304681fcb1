// File: requests.h
//
// Request messages for tests of the stream: a good configuration, frames of a
// touch, and their encodings.
#pragma once

#include <cstdint>
#include <vector>

#include "core/skin/frame.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::testing {

inline constexpr int kCodyTaxels = 16 * 24;
// Newtons per step of the u16 encoding used here; a power of two, so that the
// same values travel exactly as floats.
inline constexpr double kStep = 1.0 / 1024;

// Values in steps of kStep, one per taxel.
using Counts = std::vector<uint16_t>;

// cody-forearm, u16, every frame, release only by end_of_trial.
// The built-in model that serves streams without poses.
inline constexpr char kModelWithoutPoses[] = "models/no-poses";
v1::ClassifyContactRequest ConfigRequest(const std::string& model = "");
v1::ClassifyContactRequest EndOfTrialRequest();

// An untouched frame, and one with `taxels` neighbours pressed at `newton`.
Counts Untouched();
Counts Touch(double newton, int taxels = 4);
// `frames` frames: some untouched, then a touch that grows and wanders.
std::vector<Counts> Contact(int frames, uint64_t seed);

// Dense frames from `sequence` on, captured at 100 Hz.
v1::ClassifyContactRequest DenseU16(uint64_t sequence,
                                    const std::vector<Counts>& frames);
v1::ClassifyContactRequest DenseF32(uint64_t sequence,
                                    const std::vector<Counts>& frames);
v1::ClassifyContactRequest SparseU16(uint64_t sequence,
                                     const std::vector<Counts>& frames);
v1::ClassifyContactRequest SparseF32(uint64_t sequence,
                                     const std::vector<Counts>& frames);
// Appends seven numbers.
void AddPose(const Pose& pose, v1::FrameBatch* batch);

// What the server must see: the values in newtons.
std::vector<float> Newtons(const Counts& counts);

}  // namespace tactus::internal::testing
