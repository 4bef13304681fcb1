// File: local_session.h
//
// LocalModel and LocalSession: a stream in this process as the messages of the
// wire, so that the Python package reads its answers as those of a server.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto model, LocalModel::Load("a.tactus"));
//   TACTUS_ASSIGN_OR_RETURN(const auto session,
//                           LocalSession::Open(model, config));
//   TACTUS_RETURN_IF_ERROR(session->Take(request));
//   for (const std::string& response : session->TakeResponses()) Use(response);
//
// A model is immutable and may be shared by threads; a session belongs to one
// thread. After an error, a session takes nothing more.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/compiled_model.h"
#include "core/stream/answer_sink.h"
#include "core/stream/contact_session.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::python {

struct LocalModel {
  // Checks that the model computes here what it computed where it was made.
  // IO, BUNDLE_CORRUPT, BUNDLE_VERSION, INVALID_MODEL.
  static absl::StatusOr<std::shared_ptr<const LocalModel>> Load(
      const std::string& path);
  // The same of a bundle in memory, which answers say is `path`.
  static absl::StatusOr<std::shared_ptr<const LocalModel>> Decode(
      absl::string_view bundle, const std::string& path);

  std::shared_ptr<const CompiledModel> model;
  std::string path;
  std::string sha256;
};

class LocalSession : private AnswerSink {
 public:
  // `config` is a serialised v1::StreamConfig, whose `model` is not looked at.
  // The errors of a server, and MALFORMED_REQUEST.
  static absl::StatusOr<std::unique_ptr<LocalSession>> Open(
      const std::shared_ptr<const LocalModel>& model, absl::string_view config);

  // The serialised v1::StreamStarted.
  std::string started() const { return started_.SerializeAsString(); }
  // A serialised v1::ClassifyContactRequest with frames or end_of_trial.
  absl::Status Take(absl::string_view request);
  // The serialised v1::ClassifyContactResponses since the last call.
  std::vector<std::string> TakeResponses();

 private:
  LocalSession(const StreamSettings& settings,
               std::shared_ptr<const CompiledModel> model)
      : session_(settings, std::move(model), this) {}

  v1::Answer* AddInterim() override { return AddKept(); }
  v1::Answer* AddKept() override {
    return responses_.emplace_back().mutable_answer();
  }
  v1::StreamNotice* AddNotice() override {
    return responses_.emplace_back().mutable_notice();
  }

  ContactSession session_;
  v1::StreamStarted started_;
  v1::ClassifyContactRequest request_;
  std::deque<v1::ClassifyContactResponse> responses_;
};

}  // namespace tactus::internal::python
