#include "client/training/contact_log_client.h"

#include <algorithm>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits_contact_log.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::client {

absl::StatusOr<v1::ListContactsResponse> ContactLogClient::List(
    v1::ListContactsRequest request, size_t most) {
  v1::ListContactsResponse all;
  while (true) {
    const size_t left = most - all.contacts_size();
    request.set_page_size(static_cast<int32_t>(
        std::min<size_t>(left, limits::kMaxListedContacts)));
    const auto context = client_.NewContext(client_.timeout());
    v1::ListContactsResponse page;
    const grpc::Status status =
        client_.contact_log().ListContacts(context.get(), request, &page);
    if (!status.ok()) {
      return TrainingClient::ErrorOf(status, "ListContacts", client_.timeout());
    }
    const std::string next = page.next_page_token();
    if (request.page_token().empty()) {
      all = std::move(page);
    } else {
      all.mutable_contacts()->MergeFrom(page.contacts());
    }
    all.clear_next_page_token();
    if (next.empty() || all.contacts_size() >= static_cast<int>(most)) {
      return all;
    }
    if (next == request.page_token()) {
      return InvalidResponse("next_page_token", Quoted(next),
                             "another one than that of the request");
    }
    request.set_page_token(next);
  }
}

absl::StatusOr<v1::ReplayContactResponse> ContactLogClient::Replay(
    const v1::ReplayContactRequest& request) {
  const auto timeout = client_.long_timeout();
  const auto context = client_.NewContext(timeout);
  v1::ReplayContactResponse response;
  const grpc::Status status =
      client_.contact_log().ReplayContact(context.get(), request, &response);
  if (!status.ok()) {
    return TrainingClient::ErrorOf(status, "ReplayContact", timeout);
  }
  return response;
}

absl::StatusOr<v1::DatasetVersion> ContactLogClient::Label(
    const v1::LabelContactsRequest& request) {
  const auto timeout = client_.long_timeout();
  const auto context = client_.NewContext(timeout);
  v1::LabelContactsResponse response;
  const grpc::Status status =
      client_.contact_log().LabelContacts(context.get(), request, &response);
  if (!status.ok()) {
    return TrainingClient::ErrorOf(status, "LabelContacts", timeout);
  }
  return std::move(*response.mutable_version());
}

}  // namespace tactus::internal::client
