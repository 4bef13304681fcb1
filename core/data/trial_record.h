// File: trial_record.h
//
// Trials as the training service sends and stores them (proto/tactus/v1/
// trial.proto), and back.
//
//   const std::string bytes = ToRecord(trial).SerializeAsString();
//   v1::TrialRecord record;
//   record.ParseFromString(bytes);
//   TACTUS_ASSIGN_OR_RETURN(Trial same, FromRecord(record));
//
// The way there and back keeps every bit of a valid trial. A trial that names a
// preset as its layout, without a skin, comes back with the preset as its skin.
// The same trial has the same bytes, and so the same SHA-256.
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "tactus/v1/trial.pb.h"

namespace tactus {

// The record of a trial. Its geometry is the trial's skin, else the preset that
// the trial names as its layout. FromRecord refuses the record if there is
// neither.
v1::TrialRecord ToRecord(const Trial& trial);

// The trial of a record; it passes Validate(). INVALID_TRIAL, which names the
// trial and the field, for any other record. Shapes are compared before an
// array is copied, so that a refused record costs no memory.
absl::StatusOr<Trial> FromRecord(const v1::TrialRecord& record);

}  // namespace tactus
