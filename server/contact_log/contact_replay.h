// File: contact_replay.h
//
// Answers the frames of a logged contact once more, with any model.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto response,
//       ReplayContact(stored, /*place=*/0, model, {.max_frames = 200}));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/session/model_source.h"
#include "tactus/v1/contact_log.pb.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

struct ReplayOptions {
  // At least 1; frames with events come beside these.
  uint32_t max_frames = 0;
  bool with_taxels = true;
};

// `place`: that of the contact in `stored`. DATA_LOST; the errors of
// ContactPipeline::Check if the model does not fit the stream.
absl::StatusOr<v1::ReplayContactResponse> ReplayContact(
    const v1::StoredContacts& stored, uint32_t place, const PinnedModel& model,
    const ReplayOptions& options);

// Adds to each contact what `shadow` answers. The errors of ReplayContact.
absl::Status AddShadow(const PinnedModel& shadow, v1::StoredContacts* stored);

}  // namespace tactus::internal::server
