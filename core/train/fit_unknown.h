// File: fit_unknown.h
//
// Fitting what `unknown` compares a contact with (UnknownProbability in
// calibration.h): how likely the best class is, and how stiff the object is
// estimated to be.
//
// A contact is called unknown if its likelihood lies below a quantile of the
// held-out contacts, or its stiffness outside of two quantiles. As many
// held-out contacts lie below the first as outside of the other two, and one
// held-out contact in twenty is called unknown for either reason. Quantiles
// replace a standard deviation, because the likelihood's lower tail is heavy.
//
//   FitUnknown(scored, model.calibration);
//
// Thread-safe: free functions without state.
#pragma once

#include <span>

#include "core/train/calibrate.h"

namespace tactus {

// Fraction of held-out contacts that `unknown` may be above one half for.
inline constexpr double kFalseAlarms = 0.05;

// Sets the tables of evidence and stiffness at each entry of
// `calibration.frames`. Those of the stiffness stay empty if fewer than
// kMinEstimates contacts have an estimate at one of the entries.
inline constexpr size_t kMinEstimates = 40;
void FitUnknown(std::span<const ScoredContact> contacts,
                Calibration& calibration);

}  // namespace tactus
