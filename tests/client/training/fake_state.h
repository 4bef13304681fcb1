// File: fake_state.h
//
// What the services of a FakeTrainingServer share. The mutex guards the data.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "tests/client/training/fake_training_server.h"

namespace tactus::internal::client::testing {

inline constexpr int64_t kNever = -1;

inline bool Ended(const v1::Operation& operation) {
  return operation.state() >= v1::Operation::STATE_SUCCEEDED;
}

struct FakeVersion {
  v1::DatasetVersion info;
  // Serialized records by SHA-256.
  std::map<std::string, std::string> records;
  std::map<std::string, v1::TrialInfo> trials;
};

struct FakeDataset {
  v1::Dataset info;
  std::vector<FakeVersion> versions;
};

struct FakeUpload {
  v1::CreateUploadRequest request;
  std::string bytes;
  std::string version;
};

struct FakeJob {
  v1::Operation operation;
  std::vector<v1::LearningPoint> points;
};

struct FakeState {
  explicit FakeState(FakeTrainingServer* fake) : owner(fake) {}

  // Begins a call.
  grpc::Status Begin(const char* method) {
    return owner->refuse ? owner->refuse(method) : grpc::Status::OK;
  }
  grpc::Status End(google::protobuf::Message& response) {
    if (owner->alter) owner->alter(response);
    return grpc::Status::OK;
  }

  // Null if there is none.
  FakeVersion* FindVersion(const std::string& name) {
    for (auto& [dataset, entry] : datasets) {
      if (name == dataset && !entry.versions.empty()) {
        return &entry.versions.back();
      }
      for (FakeVersion& version : entry.versions) {
        if (version.info.name() == name) return &version;
      }
    }
    return nullptr;
  }

  FakeTrainingServer* const owner;
  std::mutex mutex;
  std::condition_variable changed;
  bool stopping = false;
  std::map<std::string, FakeDataset> datasets;
  std::map<std::string, FakeUpload> uploads;
  std::map<std::string, FakeJob> jobs;
  std::map<std::string, std::string> requests;
  std::vector<std::pair<v1::ModelVersion, std::string>> models;
  std::map<std::string, v1::Alias> aliases;
  std::map<std::string, std::vector<v1::AliasChange>> history;
  v1::Operation new_job;
  v1::PromoteModelRequest promotion;
  v1::UpdateAliasRequest update;
  v1::TrainSpec train_spec;
  int watchers = 0;
  int64_t break_upload_at = kNever;
  FakeTrainingServer::Kept kept = FakeTrainingServer::Kept::kAll;
  int64_t break_download_at = kNever;
  int break_watches = 0;
  int64_t bytes_received = 0;
  int write_calls = 0;
};

}  // namespace tactus::internal::client::testing
