// File: fake_training_service.h
//
// The TrainingService of a FakeTrainingServer.
#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/data/trial_pack.h"
#include "core/data/trial_record.h"
#include "server/rpc/status.h"
#include "tests/client/training/fake_state.h"

namespace tactus::internal::client::testing {

class FakeTrainingService : public v1::TrainingService::Service {
 public:
  explicit FakeTrainingService(FakeState* state) : state_(*state) {}

  grpc::Status CreateDataset(grpc::ServerContext*,
                             const v1::CreateDatasetRequest* request,
                             v1::CreateDatasetResponse* response) override {
    if (grpc::Status s = state_.Begin("CreateDataset"); !s.ok()) return s;
    const std::lock_guard lock(state_.mutex);
    if (state_.datasets.contains(request->name())) {
      return server::ToGrpcStatus(DatasetExists(request->name()));
    }
    v1::Dataset& info = state_.datasets[request->name()].info;
    info.set_name(request->name());
    info.set_description(request->description());
    info.set_create_time_ms(1'700'000'000'000);
    *response->mutable_dataset() = info;
    return state_.End(*response);
  }

  grpc::Status GetDataset(grpc::ServerContext*,
                          const v1::GetDatasetRequest* request,
                          v1::GetDatasetResponse* response) override {
    if (grpc::Status s = state_.Begin("GetDataset"); !s.ok()) return s;
    const std::lock_guard lock(state_.mutex);
    const auto found = state_.datasets.find(request->name());
    if (found == state_.datasets.end()) return NoDataset(request->name());
    *response->mutable_dataset() = found->second.info;
    for (const FakeVersion& version : found->second.versions) {
      *response->add_versions() = version.info;
    }
    return state_.End(*response);
  }

  grpc::Status ListDatasets(grpc::ServerContext*,
                            const v1::ListDatasetsRequest* request,
                            v1::ListDatasetsResponse* response) override {
    if (grpc::Status s = state_.Begin("ListDatasets"); !s.ok()) return s;
    const std::lock_guard lock(state_.mutex);
    // Two on each page.
    auto next = state_.datasets.upper_bound(request->page_token());
    for (int i = 0; i < 2 && next != state_.datasets.end(); ++i, ++next) {
      *response->add_datasets() = next->second.info;
    }
    if (next != state_.datasets.end()) {
      response->set_next_page_token(
          response->datasets(response->datasets_size() - 1).name());
    }
    return state_.End(*response);
  }

  grpc::Status DeleteDataset(grpc::ServerContext*,
                             const v1::DeleteDatasetRequest* request,
                             v1::DeleteDatasetResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    if (state_.datasets.erase(request->name()) == 0) {
      return NoDataset(request->name());
    }
    response->set_removed_trials(7);
    return state_.End(*response);
  }

  grpc::Status GetDatasetVersion(
      grpc::ServerContext*, const v1::GetDatasetVersionRequest* request,
      v1::GetDatasetVersionResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const FakeVersion* version = state_.FindVersion(request->name());
    if (version == nullptr) return NoDataset(request->name());
    *response->mutable_version() = version->info;
    return state_.End(*response);
  }

  grpc::Status ListTrials(grpc::ServerContext*,
                          const v1::ListTrialsRequest* request,
                          v1::ListTrialsResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const FakeVersion* version = state_.FindVersion(request->dataset_version());
    if (version == nullptr) return NoDataset(request->dataset_version());
    // Three on each page.
    for (const auto& [id, trial] : version->trials) {
      if (id <= request->page_token()) continue;
      if (!request->label().empty() && trial.label() != request->label()) {
        continue;
      }
      if (response->trials_size() == 3) {
        response->set_next_page_token(response->trials(2).id());
        break;
      }
      *response->add_trials() = trial;
    }
    return state_.End(*response);
  }

  grpc::Status DownloadTrials(
      grpc::ServerContext*, const v1::DownloadTrialsRequest* request,
      grpc::ServerWriter<v1::DownloadTrialsResponse>* writer) override {
    if (grpc::Status s = state_.Begin("DownloadTrials"); !s.ok()) return s;
    const std::string pack = state_.owner->PackOf(request->dataset_version());
    for (size_t at = 0; at < pack.size(); at += state_.owner->download_bytes) {
      {
        const std::lock_guard lock(state_.mutex);
        if (state_.break_download_at != kNever &&
            static_cast<int64_t>(at) >= state_.break_download_at) {
          state_.break_download_at = kNever;
          return grpc::Status(grpc::StatusCode::UNAVAILABLE, "broken");
        }
      }
      v1::DownloadTrialsResponse response;
      response.set_data(pack.substr(at, state_.owner->download_bytes));
      state_.End(response);
      writer->Write(response);
    }
    return grpc::Status::OK;
  }

  grpc::Status CreateUpload(grpc::ServerContext*,
                            const v1::CreateUploadRequest* request,
                            v1::CreateUploadResponse* response) override {
    if (grpc::Status s = state_.Begin("CreateUpload"); !s.ok()) return s;
    const std::lock_guard lock(state_.mutex);
    if (!state_.datasets.contains(request->dataset())) {
      return NoDataset(request->dataset());
    }
    std::string& name = state_.requests[request->request_id()];
    if (name.empty()) {
      name = absl::StrCat("uploads/", state_.uploads.size() + 1);
      state_.uploads[name].request = *request;
    }
    response->set_upload(name);
    response->set_committed_size(
        static_cast<int64_t>(state_.uploads[name].bytes.size()));
    return state_.End(*response);
  }

  grpc::Status WriteUpload(grpc::ServerContext*,
                           grpc::ServerReader<v1::WriteUploadRequest>* reader,
                           v1::WriteUploadResponse* response) override {
    if (grpc::Status s = state_.Begin("WriteUpload"); !s.ok()) return s;
    {
      const std::lock_guard lock(state_.mutex);
      ++state_.write_calls;
    }
    v1::WriteUploadRequest request;
    FakeUpload* upload = nullptr;
    // Bytes of this call; on disk at its end.
    std::string pending;
    while (reader->Read(&request)) {
      const std::lock_guard lock(state_.mutex);
      if (!request.upload().empty()) upload = &state_.uploads[request.upload()];
      if (upload == nullptr) return server::ToGrpcStatus(EmptyRequest());
      const auto size =
          static_cast<int64_t>(upload->bytes.size() + pending.size());
      if (request.write_offset() != size) {
        return server::ToGrpcStatus(
            OffsetMismatch(request.write_offset(), size));
      }
      if (request.data().empty() || request.data().size() > 1024 * 1024 ||
          request.crc32c() != ExtendCrc32c(0, request.data())) {
        return server::ToGrpcStatus(ChecksumMismatch("chunk", "?", "?"));
      }
      if (Break(size)) return Lose(upload, pending);
      pending += request.data();
      state_.bytes_received += static_cast<int64_t>(request.data().size());
      if (Break(size + static_cast<int64_t>(request.data().size()))) {
        return Lose(upload, pending);
      }
    }
    const std::lock_guard lock(state_.mutex);
    upload->bytes += pending;
    response->set_committed_size(static_cast<int64_t>(upload->bytes.size()));
    return state_.End(*response);
  }

  grpc::Status QueryWriteStatus(
      grpc::ServerContext*, const v1::QueryWriteStatusRequest* request,
      v1::QueryWriteStatusResponse* response) override {
    if (grpc::Status s = state_.Begin("QueryWriteStatus"); !s.ok()) return s;
    const std::lock_guard lock(state_.mutex);
    const FakeUpload& upload = state_.uploads[request->upload()];
    response->set_committed_size(static_cast<int64_t>(upload.bytes.size()));
    response->set_dataset_version(upload.version);
    return state_.End(*response);
  }

  grpc::Status FinishUpload(grpc::ServerContext*,
                            const v1::FinishUploadRequest* request,
                            v1::FinishUploadResponse* response) override {
    if (grpc::Status s = state_.Begin("FinishUpload"); !s.ok()) return s;
    const std::lock_guard lock(state_.mutex);
    FakeUpload& upload = state_.uploads[request->upload()];
    if (static_cast<int64_t>(upload.bytes.size()) != request->size() ||
        ExtendCrc32c(0, upload.bytes) != request->crc32c()) {
      return server::ToGrpcStatus(
          ChecksumMismatch(request->upload(), "?", "?"));
    }
    if (upload.version.empty()) {
      if (const absl::Status made = MakeVersion(upload); !made.ok()) {
        return server::ToGrpcStatus(made);
      }
    }
    *response->mutable_version() = state_.FindVersion(upload.version)->info;
    return state_.End(*response);
  }

  grpc::Status TrainModel(grpc::ServerContext*,
                          const v1::TrainModelRequest* request,
                          v1::TrainModelResponse* response) override {
    if (grpc::Status s = state_.Begin("TrainModel"); !s.ok()) return s;
    const std::lock_guard lock(state_.mutex);
    state_.train_spec = request->spec();
    if (state_.FindVersion(request->spec().dataset_version()) == nullptr) {
      return NoDataset(request->spec().dataset_version());
    }
    v1::Operation operation = state_.new_job;
    operation.set_kind(v1::Operation::KIND_TRAIN);
    *operation.mutable_train() = request->spec();
    AddJob(operation, response->mutable_operation());
    return state_.End(*response);
  }

  grpc::Status EvaluateModel(grpc::ServerContext*,
                             const v1::EvaluateModelRequest* request,
                             v1::EvaluateModelResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    v1::Operation operation = state_.new_job;
    operation.set_kind(v1::Operation::KIND_EVALUATE);
    *operation.mutable_evaluate() = request->spec();
    AddJob(operation, response->mutable_operation());
    return state_.End(*response);
  }

 private:
  static grpc::Status NoDataset(const std::string& name) {
    return server::ToGrpcStatus(
        NoSuch(v1::ERROR_REASON_DATASET_NOT_FOUND, "dataset", name,
               "trainctl datasets list shows those that do"));
  }

  bool Break(int64_t received) {
    if (state_.break_upload_at == kNever || received < state_.break_upload_at) {
      return false;
    }
    state_.break_upload_at = kNever;
    return true;
  }

  grpc::Status Lose(FakeUpload* upload, const std::string& pending) {
    if (state_.kept == FakeTrainingServer::Kept::kAll) upload->bytes += pending;
    if (state_.kept == FakeTrainingServer::Kept::kHalf) {
      upload->bytes += pending.substr(0, pending.size() / 2);
    }
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "broken");
  }

  absl::Status MakeVersion(FakeUpload& upload) {
    FakeDataset& dataset = state_.datasets[upload.request.dataset()];
    FakeVersion version;
    if (!upload.request.replace() && !dataset.versions.empty()) {
      version = dataset.versions.back();
    }
    TrialUnpacker unpacker([&](const v1::TrialRecord& record) {
      const auto trial = FromRecord(record);
      if (!trial.ok()) return trial.status();
      const std::string bytes = record.SerializeAsString();
      version.records[record.id()] = bytes;
      v1::TrialInfo& info = version.trials[record.id()];
      info.set_sha256(Sha256Hex(bytes));
      info.set_bytes(static_cast<int64_t>(bytes.size()));
      info.set_id(record.id());
      info.set_label(record.label());
      info.set_frames(record.time_size());
      return absl::OkStatus();
    });
    if (auto status = unpacker.Add(upload.bytes); !status.ok()) return status;
    if (auto status = unpacker.Finish(); !status.ok()) return status;
    const auto number = static_cast<uint32_t>(dataset.versions.size() + 1);
    upload.version =
        absl::StrCat(upload.request.dataset(), "/versions/", number);
    version.info.Clear();
    version.info.set_name(upload.version);
    version.info.set_trials(static_cast<uint32_t>(version.trials.size()));
    for (const auto& [id, trial] : version.trials) {
      ++(*version.info.mutable_labels())[trial.label()];
      version.info.set_bytes(version.info.bytes() + trial.bytes());
    }
    version.info.set_added(static_cast<uint32_t>(unpacker.records()));
    version.info.set_create_time_ms(1'700'000'000'000);
    version.info.set_sha256(std::string(64, 'a'));
    dataset.info.set_latest_version(number);
    dataset.versions.push_back(std::move(version));
    return absl::OkStatus();
  }

  void AddJob(v1::Operation operation, v1::Operation* response) {
    const std::string name =
        absl::StrCat("operations/", state_.jobs.size() + 1);
    operation.set_name(name);
    state_.jobs[name].operation = operation;
    *response = operation;
  }

  FakeState& state_;
};

}  // namespace tactus::internal::client::testing
