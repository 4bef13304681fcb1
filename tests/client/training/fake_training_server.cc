#include "tests/client/training/fake_training_server.h"

#include <chrono>

#include "grpcpp/server_builder.h"
#include "tests/client/training/fake_model_service.h"
#include "tests/client/training/fake_operation_service.h"
#include "tests/client/training/fake_state.h"
#include "tests/client/training/fake_training_service.h"

namespace tactus::internal::client::testing {

FakeTrainingServer::FakeTrainingServer(
    const std::string& address,
    const std::shared_ptr<grpc::ServerCredentials>& credentials)
    : state_(std::make_unique<FakeState>(this)),
      training_(std::make_unique<FakeTrainingService>(state_.get())),
      operations_(std::make_unique<FakeOperationService>(state_.get())),
      models_(std::make_unique<FakeModelService>(state_.get())) {
  state_->new_job.set_state(v1::Operation::STATE_QUEUED);
  grpc::ServerBuilder builder;
  if (!address.empty()) {
    builder.AddListeningPort(address, credentials, &port_);
  }
  builder.RegisterService(training_.get());
  builder.RegisterService(operations_.get());
  builder.RegisterService(models_.get());
  server_ = builder.BuildAndStart();
}

FakeTrainingServer::~FakeTrainingServer() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
    state_->changed.notify_all();
  }
  server_->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(1));
}

std::shared_ptr<grpc::Channel> FakeTrainingServer::channel() {
  return server_->InProcessChannel({});
}

void FakeTrainingServer::BreakUploadAt(int64_t bytes, Kept kept) {
  const std::lock_guard lock(state_->mutex);
  state_->break_upload_at = bytes;
  state_->kept = kept;
}

void FakeTrainingServer::BreakDownloadAt(int64_t bytes) {
  const std::lock_guard lock(state_->mutex);
  state_->break_download_at = bytes;
}

void FakeTrainingServer::BreakWatches(int count) {
  const std::lock_guard lock(state_->mutex);
  state_->break_watches = count;
}

int64_t FakeTrainingServer::bytes_received() {
  const std::lock_guard lock(state_->mutex);
  return state_->bytes_received;
}

int FakeTrainingServer::write_calls() {
  const std::lock_guard lock(state_->mutex);
  return state_->write_calls;
}

std::string FakeTrainingServer::PackOf(const std::string& dataset) {
  const std::lock_guard lock(state_->mutex);
  const FakeVersion* version = state_->FindVersion(dataset);
  std::string pack;
  if (version == nullptr) return pack;
  for (const auto& [id, bytes] : version->records) {
    for (int i = 0; i < 4; ++i) {
      pack.push_back(static_cast<char>(bytes.size() >> (8 * i)));
    }
    pack += bytes;
  }
  return pack;
}

v1::TrainSpec FakeTrainingServer::last_train_spec() {
  const std::lock_guard lock(state_->mutex);
  return state_->train_spec;
}

v1::PromoteModelRequest FakeTrainingServer::last_promotion() {
  const std::lock_guard lock(state_->mutex);
  return state_->promotion;
}

v1::UpdateAliasRequest FakeTrainingServer::last_update() {
  const std::lock_guard lock(state_->mutex);
  return state_->update;
}

void FakeTrainingServer::SetOperation(const v1::Operation& operation) {
  const std::lock_guard lock(state_->mutex);
  state_->jobs[operation.name()].operation = operation;
  state_->changed.notify_all();
}

void FakeTrainingServer::AddPoint(const std::string& operation,
                                  const v1::LearningPoint& point) {
  const std::lock_guard lock(state_->mutex);
  state_->jobs[operation].points.push_back(point);
  state_->changed.notify_all();
}

void FakeTrainingServer::SetNewJobState(const v1::Operation& pattern) {
  const std::lock_guard lock(state_->mutex);
  state_->new_job = pattern;
}

v1::Operation FakeTrainingServer::operation(const std::string& name) {
  const std::lock_guard lock(state_->mutex);
  return state_->jobs[name].operation;
}

void FakeTrainingServer::AwaitWatchers(int count) {
  std::unique_lock lock(state_->mutex);
  state_->changed.wait(lock, [&] { return state_->watchers >= count; });
}

void FakeTrainingServer::AddModelVersion(const v1::ModelVersion& version,
                                         const std::string& bundle) {
  const std::lock_guard lock(state_->mutex);
  state_->models.emplace_back(version, bundle);
}

void FakeTrainingServer::SetAlias(const v1::Alias& alias) {
  const std::lock_guard lock(state_->mutex);
  state_->aliases[alias.name()] = alias;
}

}  // namespace tactus::internal::client::testing
