// File: logged_trial.h
//
// A logged contact as a trial of a dataset.
//
//   TACTUS_ASSIGN_OR_RETURN(const v1::TrialRecord record,
//                           TrialOf(stored, {{0, label}}));
//
// Thread-safe: a free function without state.
#pragma once

#include <cstdint>
#include <map>

#include "absl/status/statusor.h"
#include "tactus/v1/contact_log.pb.h"
#include "tactus/v1/storage.pb.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal::server {

// The trial of all frames of `stored`, with the labels of its contacts by their
// places, at least one. Of several contacts each with a label is a touch; the
// others are not mentioned. INVALID_TRIAL if it would be too large; DATA_LOST.
absl::StatusOr<v1::TrialRecord> TrialOf(
    const v1::StoredContacts& stored,
    const std::map<uint32_t, v1::ContactLabel>& labels);

}  // namespace tactus::internal::server
