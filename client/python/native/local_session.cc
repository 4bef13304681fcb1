#include "client/python/native/local_session.h"

#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/contact_pipeline.h"
#include "core/files/file_bytes.h"
#include "core/stream/stream_settings.h"
#include "core/stream/stream_started.h"

namespace tactus::internal::python {

absl::StatusOr<std::shared_ptr<const LocalModel>> LocalModel::Load(
    const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxBundleBytes));
  return Decode(bytes, path);
}

absl::StatusOr<std::shared_ptr<const LocalModel>> LocalModel::Decode(
    absl::string_view bundle, const std::string& path) {
  auto loaded = std::make_shared<LocalModel>();
  loaded->path = path;
  loaded->sha256 = BundleSha256(bundle);
  auto decoded = DecodeBundle(bundle);
  if (!decoded.ok()) return Annotate(decoded.status(), path);
  loaded->model = *std::move(decoded);
  const absl::Status same = RunWarmUp(*loaded->model);
  if (!same.ok()) return Annotate(same, path);
  return loaded;
}

absl::StatusOr<std::unique_ptr<LocalSession>> LocalSession::Open(
    const std::shared_ptr<const LocalModel>& model, absl::string_view config) {
  v1::StreamConfig parsed;
  if (!parsed.ParseFromArray(config.data(), static_cast<int>(config.size()))) {
    return MalformedRequest(config.size());
  }
  TACTUS_ASSIGN_OR_RETURN(const StreamSettings settings,
                          ParseStreamConfig(parsed));
  TACTUS_RETURN_IF_ERROR(ContactPipeline::Check(settings.layout, *model->model,
                                                settings.pipeline));
  std::unique_ptr<LocalSession> session(
      new LocalSession(settings, model->model));
  WriteStarted(settings, *model->model, &session->started_);
  session->started_.set_model_version(model->path);
  session->started_.set_bundle_sha256(model->sha256);
  return session;
}

absl::Status LocalSession::Take(absl::string_view request) {
  if (!request_.ParseFromArray(request.data(),
                               static_cast<int>(request.size()))) {
    return MalformedRequest(request.size());
  }
  if (request_.has_frames()) return session_.OnFrames(request_.frames());
  if (!request_.has_end_of_trial()) return EmptyRequest();
  session_.OnEndOfTrial();
  return absl::OkStatus();
}

std::vector<std::string> LocalSession::TakeResponses() {
  std::vector<std::string> taken;
  taken.reserve(responses_.size());
  for (const v1::ClassifyContactResponse& response : responses_) {
    taken.push_back(response.SerializeAsString());
  }
  responses_.clear();
  return taken;
}

}  // namespace tactus::internal::python
