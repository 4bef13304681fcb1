#include "client/training/monitor_client.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::client {

absl::StatusOr<std::vector<v1::OpenStream>> MonitorClient::ListStreams() {
  std::vector<v1::OpenStream> streams;
  v1::ListStreamsRequest request;
  while (true) {
    const auto context = client_.NewContext(client_.timeout());
    v1::ListStreamsResponse response;
    const grpc::Status status =
        client_.monitor().ListStreams(context.get(), request, &response);
    if (!status.ok()) {
      return TrainingClient::ErrorOf(status, "ListStreams", client_.timeout());
    }
    for (v1::OpenStream& stream : *response.mutable_streams()) {
      streams.push_back(std::move(stream));
    }
    const std::string& next = response.next_page_token();
    if (next.empty()) return streams;
    if (next == request.page_token()) {
      return InvalidResponse("next_page_token", Quoted(next),
                             "another one than that of the request");
    }
    request.set_page_token(next);
  }
}

template <typename Response, typename Call, typename Take>
absl::Status MonitorClient::Watch(const char* what, const Call& call,
                                  const Take& take) {
  shapes_.clear();
  // Without a deadline: the channel's keep-alive notices a server that is gone.
  const auto context = client_.NewContext(std::chrono::milliseconds(0));
  {
    const std::lock_guard lock(mutex_);
    if (cancelled_) return absl::CancelledError("the watch was cancelled");
    context_ = context.get();
  }
  const auto reader = call(context.get());
  absl::Status broken;
  Response response;
  while (broken.ok() && reader->Read(&response)) broken = take(response);
  if (!broken.ok()) context->TryCancel();
  const grpc::Status status = reader->Finish();
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
  TACTUS_RETURN_IF_ERROR(broken);
  if (cancelled_) return absl::CancelledError("the watch was cancelled");
  return status.ok() ? absl::OkStatus()
                     : TrainingClient::ErrorOf(status, what, {});
}

absl::Status MonitorClient::WatchStream(const v1::WatchStreamRequest& request,
                                        const OnUpdate& on_update) {
  return Watch<v1::WatchStreamResponse>(
      "WatchStream",
      [&](grpc::ClientContext* context) {
        return client_.monitor().WatchStream(context, request);
      },
      [&](const v1::WatchStreamResponse& response) {
        return OnUpdateOf(response.update(), on_update);
      });
}

absl::Status MonitorClient::WatchAll(const v1::WatchAllRequest& request,
                                     const OnUpdate& on_update,
                                     const std::function<void()>& on_response) {
  return Watch<v1::WatchAllResponse>(
      "WatchAll",
      [&](grpc::ClientContext* context) {
        return client_.monitor().WatchAll(context, request);
      },
      [&](const v1::WatchAllResponse& response) {
        for (const v1::StreamUpdate& update : response.updates()) {
          TACTUS_RETURN_IF_ERROR(OnUpdateOf(update, on_update));
        }
        on_response();
        return absl::OkStatus();
      });
}

absl::Status MonitorClient::OnUpdateOf(const v1::StreamUpdate& update,
                                       const OnUpdate& on_update) {
  TACTUS_RETURN_IF_ERROR(Check(update));
  on_update(update);
  if (update.ended()) shapes_.erase(update.stream_id());
  return absl::OkStatus();
}

absl::Status MonitorClient::Check(const v1::StreamUpdate& update) {
  const std::string& id = update.stream_id();
  if (update.has_opened()) {
    const v1::StreamStarted& started = update.opened().started();
    const v1::SensorGeometry& geometry = started.geometry();
    Shape shape;
    shape.classes = started.class_names_size();
    for (const v1::Question& question : started.questions()) {
      shape.values.push_back(question.values_size());
    }
    shape.taxel_bytes = sizeof(float) * geometry.rows() * geometry.columns() *
                        std::max(geometry.axes(), 1U);
    shapes_[id] = std::move(shape);
  }
  const auto found = shapes_.find(id);
  if (found == shapes_.end()) {
    return InvalidResponse("stream_id", Quoted(id),
                           "that of a stream which was described");
  }
  const Shape& shape = found->second;
  const std::string& taxels = update.frame().taxels();
  if (!taxels.empty() && taxels.size() != shape.taxel_bytes) {
    return InvalidResponse("bytes of taxels", taxels.size(),
                           absl::StrCat(shape.taxel_bytes));
  }
  for (const v1::Contact& contact : update.frame().answer().contacts()) {
    if (static_cast<size_t>(contact.probability_size()) != shape.classes) {
      return InvalidResponse("probabilities", contact.probability_size(),
                             absl::StrCat(shape.classes));
    }
    TACTUS_RETURN_IF_ERROR(CheckAnswers(contact, shape));
  }
  for (const v1::WatchedEvent& watched : update.events()) {
    const v1::ContactEvent& event = watched.event();
    if (event.kind() != v1::ContactEvent::KIND_DECIDED &&
        event.kind() != v1::ContactEvent::KIND_CHANGED) {
      continue;
    }
    TACTUS_RETURN_IF_ERROR(CheckValue(event.question(), event.value(), shape));
  }
  return absl::OkStatus();
}

absl::Status MonitorClient::CheckAnswers(const v1::Contact& contact,
                                         const Shape& shape) {
  if (static_cast<size_t>(contact.answers_size()) != shape.values.size()) {
    return InvalidResponse("answers", contact.answers_size(),
                           absl::StrCat(shape.values.size()));
  }
  for (int q = 0; q < contact.answers_size(); ++q) {
    const v1::QuestionAnswer& answer = contact.answers(q);
    if (answer.probability_size() != shape.values[q]) {
      return InvalidResponse("probabilities of an answer",
                             answer.probability_size(),
                             absl::StrCat(shape.values[q]));
    }
    if (!answer.has_decision()) continue;
    TACTUS_RETURN_IF_ERROR(CheckValue(q, answer.decision().value(), shape));
  }
  return absl::OkStatus();
}

absl::Status MonitorClient::CheckValue(uint32_t question, uint32_t value,
                                       const Shape& shape) {
  if (question >= shape.values.size()) {
    return InvalidResponse("question", question,
                           absl::StrCat("below ", shape.values.size()));
  }
  if (value >= static_cast<uint32_t>(shape.values[question])) {
    return InvalidResponse("value", value,
                           absl::StrCat("below ", shape.values[question]));
  }
  return absl::OkStatus();
}

void MonitorClient::Cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  if (context_ != nullptr) context_->TryCancel();
}

}  // namespace tactus::internal::client
