// File: trial_record.h
//
// Trials as the training service sends and stores them (proto/tactus/v1/
// trial.proto), and back.
//
//   const std::string bytes = ToRecord(trial).SerializeAsString();
//   TACTUS_ASSIGN_OR_RETURN(v1::TrialRecord record,
//                           ParseTrialRecord(bytes, "trial 1"));
//   TACTUS_ASSIGN_OR_RETURN(Trial same, FromRecord(record));
//
// The way there and back keeps every bit of a valid trial. A trial that names a
// preset as its layout, without a skin, comes back with the preset as its skin.
// The same trial has the same bytes, and so the same SHA-256.
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/data/trial.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal {

// The record of a trial. Its geometry is the trial's skin, else the preset that
// the trial names as its layout. FromRecord refuses the record if there is
// neither.
v1::TrialRecord ToRecord(const Trial& trial);

// The record in bytes from a stranger. INVALID_TRIAL, which calls it `name`, if
// they are none, have fields that are not known, or would take much more memory
// than their size says: more than ParsedBytesAtMost().
absl::StatusOr<v1::TrialRecord> ParseTrialRecord(absl::string_view bytes,
                                                 absl::string_view name);
int64_t ParsedBytesAtMost(int64_t record_bytes);

// The record in bytes that were checked before they were stored at `path`.
// DATA_LOST if they are none.
absl::StatusOr<v1::TrialRecord> StoredTrialRecord(const std::string& bytes,
                                                  absl::string_view path);

// The trial of a record; it passes Validate(). INVALID_TRIAL, which names the
// trial and the field, for any other record. Shapes are compared before an
// array is copied, so that a refused record costs no memory.
absl::StatusOr<Trial> FromRecord(const v1::TrialRecord& record);

}  // namespace tactus::internal
