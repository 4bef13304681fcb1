// File: contact_log_client.h
//
// ContactLogClient: the contacts that one server has kept.
//
//   ContactLogClient log(&client);
//   TACTUS_ASSIGN_OR_RETURN(const auto contacts, log.List(request, 50));
//   TACTUS_ASSIGN_OR_RETURN(const auto version, log.Label(labels));
//
// Errors as TrainingClient's. For one thread. `client` must outlive it.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "client/training/training_client.h"
#include "tactus/v1/contact_log.pb.h"

namespace tactus::internal::client {

class ContactLogClient {
 public:
  explicit ContactLogClient(TrainingClient* client) : client_(*client) {}

  // The first `most` contacts that the request is for, of as many pages as that
  // takes, and the other fields of the first page.
  absl::StatusOr<v1::ListContactsResponse> List(v1::ListContactsRequest request,
                                                size_t most);
  absl::StatusOr<v1::ReplayContactResponse> Replay(
      const v1::ReplayContactRequest& request);
  // Returns the new version of the dataset.
  absl::StatusOr<v1::DatasetVersion> Label(
      const v1::LabelContactsRequest& request);

 private:
  TrainingClient& client_;
};

}  // namespace tactus::internal::client
