// What a server counts beside its calls: data, jobs and models.
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/strip.h"
#include "core/base/version.h"
#include "server/tactus_server.h"

namespace tactus::internal::server {
namespace {

void AddOne(Family family, const Labels& labels, double value,
            Families* families) {
  Add(labels, value, &family);
  families->push_back(std::move(family));
}

std::string StateText(v1::Operation::State state) {
  return absl::AsciiStrToLower(
      absl::StripPrefix(v1::Operation::State_Name(state), "STATE_"));
}

void CollectData(TrainingBackend& backend, Families* families) {
  Family jobs = GaugeFamily("tactus_jobs", "Jobs, by state.");
  if (auto counts = backend.operations().CountByState(); counts.ok()) {
    // All states, so that the first failure is a step from 0.
    for (const auto state :
         {v1::Operation::STATE_QUEUED, v1::Operation::STATE_RUNNING,
          v1::Operation::STATE_CANCELLING, v1::Operation::STATE_SUCCEEDED,
          v1::Operation::STATE_FAILED, v1::Operation::STATE_CANCELLED}) {
      Add({{"state", StateText(state)}}, (*counts)[state], &jobs);
    }
  }
  families->push_back(std::move(jobs));
  std::error_code error;
  const auto space = std::filesystem::space(backend.data().folder(), error);
  if (error) return;
  AddOne(GaugeFamily("tactus_data_free_bytes",
                     "Free bytes of the data directory's file system."),
         {}, static_cast<double>(space.available), families);
  AddOne(GaugeFamily("tactus_data_capacity_bytes",
                     "Size of the data directory's file system."),
         {}, static_cast<double>(space.capacity), families);
}

void CollectModels(const ModelSource& models, Families* families) {
  Family info =
      GaugeFamily("tactus_model_info", "The newest version of each model.");
  for (const PinnedModel& pinned : models.Newest()) {
    Add({{"version", pinned.version_name}, {"sha256", pinned.sha256}}, 1,
        &info);
  }
  families->push_back(std::move(info));
}

}  // namespace

Families TactusServer::CollectMetrics() const {
  Families families;
  AddOne(GaugeFamily("tactus_build_info", "Release of the server."),
         {{"version", kVersion}}, 1, &families);
  AddOne(GaugeFamily("process_start_time_seconds",
                     "When the server began, in seconds since 1970 (UTC)."),
         {}, static_cast<double>(start_ms_) * 1e-3, &families);
  metrics_.rpcs.Collect(&families);
  contacts_.Collect(&families);
  metrics_.refused_streams.Collect(
      CounterFamily("tactus_streams_refused_total",
                    "Streams and trials that were refused, by reason."),
      &families);
  metrics_.answers.Collect(&families);
  CollectModels(*models_, &families);
  if (options_.training != nullptr) CollectData(*options_.training, &families);
  return families;
}

}  // namespace tactus::internal::server
