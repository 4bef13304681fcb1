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

void CollectContactLog(const ContactLog::Totals& totals, Families* families) {
  AddOne(GaugeFamily("tactus_contact_log_contacts", "Contacts that are kept."),
         {}, static_cast<double>(totals.contacts), families);
  AddOne(GaugeFamily("tactus_contact_log_bytes", "What they have on disk."), {},
         static_cast<double>(totals.bytes), families);
  AddOne(GaugeFamily("tactus_contact_log_max_bytes", "What they may have."), {},
         static_cast<double>(totals.max_bytes), families);
  AddOne(CounterFamily("tactus_contact_log_left_out_total",
                       "Contacts, or several at the same time, that could not "
                       "be kept."),
         {}, static_cast<double>(totals.left_out), families);
  Family shadow = CounterFamily(
      "tactus_shadow_contacts_total",
      "Contacts that a shadow answered, by whether the served model did so, "
      "too.");
  Add({{"answer", "same"}}, static_cast<double>(totals.shadow_agrees), &shadow);
  Add({{"answer", "other"}}, static_cast<double>(totals.shadow_differs),
      &shadow);
  families->push_back(std::move(shadow));
  AddOne(CounterFamily("tactus_shadow_skipped_total",
                       "Recordings that no shadow answered, because the server "
                       "was busy."),
         {}, static_cast<double>(totals.shadow_skipped), families);
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
  if (options_.contact_log != nullptr) {
    CollectContactLog(options_.contact_log->totals(), &families);
  }
  return families;
}

}  // namespace tactus::internal::server
