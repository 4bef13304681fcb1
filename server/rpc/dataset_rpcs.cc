#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_training.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "server/records/memory_budget.h"
#include "server/records/pinned_version.h"
#include "server/rpc/control_handlers.h"
#include "server/rpc/training_rpcs.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kDatasetService[] = "/tactus.v1.TrainingService/";

template <typename Message>
void SetPage(Page<typename Message::value_type>&& page, Message* items,
             std::string* next_token) {
  for (auto& item : page.items) *items->Add() = std::move(item);
  *next_token = std::move(page.next_token);
}

// Waits for the memory of a version's list of trials.
MemoryBudget::Lease ListingLease(TrainingBackend& backend,
                                 const PinnedVersion& version) {
  return backend.listing().Take(int64_t{version.info().trials()} *
                                limits::kListedTrialBytes);
}

// What a download keeps of a trial for as long as its client takes.
struct Record {
  // The bytes of TrialInfo.sha256.
  std::array<char, 32> sha256;
  uint32_t bytes;
};

// In the order of the version's trials.
absl::StatusOr<std::vector<Record>> Records(TrainingBackend& backend,
                                            const PinnedVersion& version) {
  const MemoryBudget::Lease lease = ListingLease(backend, version);
  TACTUS_ASSIGN_OR_RETURN(const auto trials, version.Trials());
  std::vector<Record> records;
  records.reserve(trials.size());
  for (const v1::TrialInfo& trial : trials) {
    const std::string sha256 = absl::HexStringToBytes(trial.sha256());
    Record& record = records.emplace_back();
    std::copy_n(sha256.begin(), std::min(sha256.size(), record.sha256.size()),
                record.sha256.begin());
    record.bytes = static_cast<uint32_t>(trial.bytes());
  }
  return records;
}

// The memory of the records of one download, if the budget has it.
class HeldRecords {
 public:
  HeldRecords(MemoryBudget& budget, int64_t trials)
      : budget_(budget),
        bytes_(trials * int64_t{sizeof(Record)}),
        held_(budget.TryTake(bytes_)) {}
  ~HeldRecords() {
    if (held_) budget_.Return(bytes_);
  }
  HeldRecords(const HeldRecords&) = delete;
  HeldRecords& operator=(const HeldRecords&) = delete;

  bool held() const { return held_; }

 private:
  MemoryBudget& budget_;
  const int64_t bytes_;
  const bool held_;
};

absl::Status DownloadTrials(TrainingBackend& backend,
                            const v1::DownloadTrialsRequest& request,
                            ControlStream& stream) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto version,
      PinnedVersion::Find(backend.data(), backend.datasets(),
                          request.dataset_version()));
  const HeldRecords records(backend.downloads(), version.info().trials());
  if (!records.held()) return DownloadLimit(limits::kMaxDownloadBytes);
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Record> trials,
                          Records(backend, version));
  v1::DownloadTrialsResponse response;
  std::string& data = *response.mutable_data();
  const auto add = [&](absl::string_view bytes) -> absl::Status {
    while (!bytes.empty()) {
      const size_t part =
          std::min(bytes.size(), limits::kMaxChunkBytes - data.size());
      data.append(bytes.data(), part);
      bytes.remove_prefix(part);
      if (data.size() < limits::kMaxChunkBytes) continue;
      TACTUS_RETURN_IF_ERROR(WriteMessage(stream, response));
      data.clear();
    }
    return absl::OkStatus();
  };
  for (const Record& trial : trials) {
    char head[sizeof trial.bytes];
    std::memcpy(head, &trial.bytes, sizeof head);
    TACTUS_RETURN_IF_ERROR(add({head, sizeof head}));
    const std::string sha256 =
        absl::BytesToHexString({trial.sha256.data(), trial.sha256.size()});
    TACTUS_RETURN_IF_ERROR(version.ReadRecord(sha256, add));
  }
  return data.empty() ? absl::OkStatus() : WriteMessage(stream, response);
}

absl::StatusOr<v1::ListTrialsResponse> ListTrials(
    TrainingBackend& backend, const v1::ListTrialsRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(const int size, PageSize(request.page_size()));
  TACTUS_ASSIGN_OR_RETURN(
      const auto version,
      PinnedVersion::Find(backend.data(), backend.datasets(),
                          request.dataset_version()));
  const MemoryBudget::Lease lease = ListingLease(backend, version);
  TACTUS_ASSIGN_OR_RETURN(auto trials, version.Trials());
  const auto key = [](const v1::TrialInfo& trial) {
    return absl::StrCat(trial.id(), "/", trial.sha256());
  };
  v1::ListTrialsResponse response;
  bool behind = request.page_token().empty();
  for (v1::TrialInfo& trial : trials) {
    if (!behind) {
      behind = key(trial) == request.page_token();
      continue;
    }
    if ((!request.label().empty() && trial.label() != request.label()) ||
        (!request.condition().empty() &&
         trial.condition() != request.condition()) ||
        (!request.material().empty() &&
         trial.material() != request.material())) {
      continue;
    }
    if (response.trials_size() == size) {
      response.set_next_page_token(key(response.trials(size - 1)));
      break;
    }
    *response.add_trials() = std::move(trial);
  }
  if (!behind) {
    return InvalidConfig("page_token", Quoted(request.page_token()),
                         "the next_page_token of the page before");
  }
  return response;
}

}  // namespace

void AddDatasetRpcs(TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const std::string& method, Role role,
                       ControlService::Handler handler) {
    AddRpc(backend, control, kDatasetService + method, role,
           std::move(handler));
  };
  add("CreateDataset", Role::kTrainer,
      Unary<v1::CreateDatasetRequest, v1::CreateDatasetResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::CreateDatasetResponse> {
            v1::CreateDatasetResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_dataset(),
                backend->datasets().Create(request.name(),
                                           request.description(), caller));
            return response;
          }));
  add("GetDataset", Role::kTrainer,
      Unary<v1::GetDatasetRequest, v1::GetDatasetResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::GetDatasetResponse> {
            TACTUS_ASSIGN_OR_RETURN(
                auto history, backend->datasets().GetHistory(request.name()));
            v1::GetDatasetResponse response;
            *response.mutable_dataset() = std::move(history.dataset);
            for (auto& version : history.versions) {
              *response.add_versions() = std::move(version);
            }
            return response;
          }));
  add("ListDatasets", Role::kTrainer,
      Unary<v1::ListDatasetsRequest, v1::ListDatasetsResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::ListDatasetsResponse> {
            TACTUS_ASSIGN_OR_RETURN(const int size,
                                    PageSize(request.page_size()));
            TACTUS_ASSIGN_OR_RETURN(auto page, backend->datasets().List(
                                                   size, request.page_token()));
            v1::ListDatasetsResponse response;
            SetPage(std::move(page), response.mutable_datasets(),
                    response.mutable_next_page_token());
            return response;
          }));
  add("DeleteDataset", Role::kAdmin,
      Unary<v1::DeleteDatasetRequest, v1::DeleteDatasetResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::DeleteDatasetResponse> {
            TACTUS_ASSIGN_OR_RETURN(
                const uint32_t removed,
                backend->datasets().Delete(request.name(), caller));
            v1::DeleteDatasetResponse response;
            response.set_removed_trials(removed);
            return response;
          }));
  add("RelabelTrials", Role::kTrainer,
      Unary<v1::RelabelTrialsRequest, v1::RelabelTrialsResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::RelabelTrialsResponse> {
            v1::RelabelTrialsResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_version(),
                backend->datasets().Relabel(request, caller));
            return response;
          }));
  add("RemoveTrials", Role::kTrainer,
      Unary<v1::RemoveTrialsRequest, v1::RemoveTrialsResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::RemoveTrialsResponse> {
            v1::RemoveTrialsResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_version(),
                backend->datasets().Remove(request, caller));
            return response;
          }));
  add("GetDatasetVersion", Role::kTrainer,
      Unary<v1::GetDatasetVersionRequest, v1::GetDatasetVersionResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::GetDatasetVersionResponse> {
            v1::GetDatasetVersionResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_version(),
                backend->datasets().Version(request.name()));
            return response;
          }));
  add("ListTrials", Role::kTrainer,
      Unary<v1::ListTrialsRequest, v1::ListTrialsResponse>(
          [=](const auto& request, const Caller&) {
            return ListTrials(*backend, request);
          }));
  add("DownloadTrials", Role::kTrainer,
      ServerStream<v1::DownloadTrialsRequest>(
          [=](const auto& request, ControlStream& stream) {
            return DownloadTrials(*backend, request, stream);
          }));
}

}  // namespace tactus::internal::server
