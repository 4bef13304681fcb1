// File: fit_unknown.h
//
// Fitting what `unknown` compares a contact with (UnknownProbability in
// calibration.h): how likely the best class is, and how stiff the object is
// estimated to be.
//
// The borders are quantiles of the held-out contacts, not multiples of a
// standard deviation, because the lower tail of the likelihood is heavy. Most
// of the false alarms are left to the likelihood. Few are enough for softness:
// the estimates of an object half as stiff as the softest of training lie below
// nearly all of the held-out ones.
//
//   FitUnknown(scored, model.calibration);
//
// Thread-safe: free functions without state.
#pragma once

#include <span>

#include "core/train/calibrate.h"

namespace tactus::internal {

// Fraction of held-out contacts that are called unknown at most, and that of
// those called unknown because their object is soft.
inline constexpr double kFalseAlarms = 0.05;
inline constexpr double kSoftFalseAlarms = 0.01;

// Fewer estimates say too little of the softest object.
inline constexpr size_t kMinEstimates = 40;

// Sets the tables of the evidence and `softest` at each entry of
// `calibration.frames`. `softest` becomes empty if fewer than kMinEstimates
// contacts have an estimate at one of the entries; then all false alarms are
// left to the likelihood. There must be at least one contact, and each contact
// has one score and, if any, one estimate for each entry.
void FitUnknown(std::span<const ScoredContact> contacts,
                Calibration& calibration);

}  // namespace tactus::internal
