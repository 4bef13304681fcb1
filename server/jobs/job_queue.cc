#include "server/jobs/job_queue.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/base/status_proto.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/store/lost_and_found.h"
#include "server/names/resource_names.h"
#include "server/trainer/exit_status.h"
#include "server/trainer/job_files.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using v1::Operation;

constexpr milliseconds kPoll(100);
// For a process that was asked to end.
constexpr milliseconds kPatience(5'000);
// After an error of storage.
constexpr milliseconds kRest(1'000);
constexpr int64_t kBytesPerMib = 1024L * 1024;
constexpr int64_t kMaxOutcomeBytes = 16L * 1024 * 1024;

// The status of a process that ended without an outcome, or that something else
// than a request to cancel has asked to end: a service manager that stops the
// server asks its jobs too.
bool IsInterrupted(const absl::Status& status) {
  const std::string reason = ReasonOf(status);
  return reason == "JOB_CRASHED" || reason == "CANCELLED";
}

}  // namespace

JobQueue::JobQueue(DataDirectory* data, DatasetStore* datasets,
                   ModelStore* models, OperationStore* operations,
                   Options options, NowMs now)
    : data_(data),
      datasets_(datasets),
      models_(models),
      operations_(operations),
      options_(std::move(options)),
      now_(std::move(now)) {}

JobQueue::~JobQueue() { Stop(); }

void JobQueue::Start() {
  RemoveFolders();
  training_ = std::thread([this] { Serve(true); });
  others_ = std::thread([this] { Serve(false); });
}

void JobQueue::RemoveFolders() {
  const auto folders = data_->files().List(data_->JobFolder());
  if (!folders.ok()) return;
  LostAndFound lost(data_->files(), data_->folder());
  for (const std::string& id : *folders) {
    const auto operation = operations_->Get(absl::StrCat("operations/", id));
    if (operation.ok() && HasEnded(*operation)) {
      KeepLog(operation->name(), id);
      data_->files().RemoveAll(data_->JobPath(id)).IgnoreError();
    } else if (absl::IsNotFound(operation.status())) {
      // The catalogue is an older copy. The number will be given again.
      const absl::Status taken = lost.Take(absl::StrCat("jobs/", id));
      spdlog::warn("jobs/{} belongs to no operation: {}", id,
                   taken.ok() ? lost.folder() : taken.ToString());
    }
  }
}

void JobQueue::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    wake_.notify_all();
  }
  if (training_.joinable()) training_.join();
  if (others_.joinable()) others_.join();
}

void JobQueue::Wake() {
  const std::lock_guard lock(mutex_);
  ++wakes_;
  wake_.notify_all();
}

absl::StatusOr<Operation> JobQueue::Cancel(absl::string_view name) {
  const auto operation = operations_->Change(name, [&](Operation& job) {
    if (job.state() == Operation::STATE_QUEUED) {
      job.set_state(Operation::STATE_CANCELLED);
      job.set_end_time_ms(now_());
    } else if (job.state() == Operation::STATE_RUNNING) {
      job.set_state(Operation::STATE_CANCELLING);
    }
    return absl::OkStatus();
  });
  if (operation.ok() && operation->state() == Operation::STATE_CANCELLING) {
    const std::lock_guard lock(mutex_);
    cancelled_.insert(operation->name());
  }
  return operation;
}

absl::StatusOr<std::optional<v1::StoredLog>> JobQueue::ReadLog(
    const std::string& id) const {
  const std::string path = data_->JobPath(id) + "/log";
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, data_->files().Size(path));
  if (size < 0) return std::nullopt;
  const int64_t kept = std::min(size, limits::kMaxJobLogBytes);
  v1::StoredLog log;
  log.set_omitted_bytes(size - kept);
  if (kept > 0) {
    TACTUS_ASSIGN_OR_RETURN(*log.mutable_data(),
                            data_->files().Read(path, size - kept, kept));
  }
  return log;
}

void JobQueue::KeepLog(const std::string& name, const std::string& id) {
  const auto log = ReadLog(id);
  absl::Status status = log.status();
  if (log.ok() && log->has_value()) status = operations_->SaveLog(name, **log);
  // The job matters more than its log.
  if (!status.ok()) {
    spdlog::warn("{}: its log is not kept: {}", name, status.ToString());
  }
}

absl::StatusOr<v1::StoredLog> JobQueue::Log(absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const Operation operation, operations_->Get(name));
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, "operations"));
  // The file goes after the job has ended, perhaps now, so it is read before
  // what was saved.
  if (!HasEnded(operation)) {
    auto live = ReadLog(parsed.id);
    if (live.ok() && live->has_value()) return **std::move(live);
  }
  TACTUS_ASSIGN_OR_RETURN(auto saved, operations_->SavedLog(name));
  return saved.has_value() ? *std::move(saved) : v1::StoredLog();
}

bool JobQueue::IsCancelled(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return cancelled_.contains(name);
}

JobQueue::Job JobQueue::NextJob(bool training) {
  std::vector<Operation::State> states = {Operation::STATE_QUEUED};
  // What another server runs is its own as long as it lives.
  if (data_->is_shared()) {
    states.push_back(Operation::STATE_RUNNING);
    states.push_back(Operation::STATE_CANCELLING);
  }
  auto waiting = operations_->InStates(states);
  while (!waiting.ok() && !stopping_) {
    Rest(training, "jobs", waiting.status());
    waiting = operations_->InStates(states);
  }
  if (!waiting.ok()) return {};
  // Most of those that run have a server that lives.
  std::stable_partition(waiting->begin(), waiting->end(),
                        [](const Operation& operation) {
                          return operation.state() == Operation::STATE_QUEUED;
                        });
  for (const Operation& operation : *waiting) {
    if ((operation.kind() == Operation::KIND_TRAIN) != training) continue;
    auto lock = data_->locks().TryTake(operation.name());
    if (lock.ok() && *lock != nullptr) {
      return {operation.name(), *std::move(lock)};
    }
  }
  return {};
}

bool JobQueue::IsOwn(const Job& job) const {
  return !absl::IsAborted(data_->catalog().Look(
      [&](const Transaction& look) { return job.lock->StillHeld(look); }));
}

void JobQueue::LookForCancellation(const std::string& name) {
  const auto operation = operations_->Get(name);
  if (!operation.ok() || operation->state() != Operation::STATE_CANCELLING) {
    return;
  }
  const std::lock_guard lock(mutex_);
  cancelled_.insert(name);
}

void JobQueue::Serve(bool training) {
  uint64_t seen = 0;
  while (!stopping_) {
    {
      const std::lock_guard lock(mutex_);
      seen = wakes_;
    }
    const Job job = NextJob(training);
    if (!job.name.empty()) {
      Run(job, training);
      continue;
    }
    std::unique_lock lock(mutex_);
    wake_.wait(lock, [&] { return stopping_ || wakes_ != seen; });
  }
}

void JobQueue::Rest(bool training, absl::string_view what,
                    const absl::Status& error) {
  RetryLog& log = storage_[training];
  if (log.Fails()) {
    spdlog::error("{}: {} (tried {} times, and again each second)",
                  std::string(what), error.ToString(), log.failures());
  }
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, kRest, [&] { return stopping_.load(); });
}

void JobQueue::Run(const Job& job, bool training) {
  const std::string& name = job.name;
  auto operation = operations_->Change(
      name,
      [&](Operation& found) {
        // It may have been cancelled in between.
        if (HasEnded(found)) return WorkCancelled(found.name());
        if (found.state() == Operation::STATE_CANCELLING) {
          // Its server died before it could end it.
          found.set_state(Operation::STATE_CANCELLED);
          found.set_end_time_ms(now_());
          return absl::OkStatus();
        }
        found.set_state(Operation::STATE_RUNNING);
        found.set_attempts(found.attempts() + 1);
        if (found.start_time_ms() == 0) found.set_start_time_ms(now_());
        return absl::OkStatus();
      },
      job.lock.get());
  if (!operation.ok()) {
    if (ReasonOf(operation.status()) == "CANCELLED") return;
    return Rest(training, name, operation.status());
  }
  if (HasEnded(*operation)) return RemoveFolder(name);
  spdlog::info("{}: attempt {}, for {}{}{}", name, operation->attempts(),
               Printable(operation->requester()),
               operation->request_id().empty() ? "" : ", request ",
               Printable(operation->request_id()));
  Operation done = *operation;
  absl::Status status = RunProcess(*job.lock, done);
  // A job has no part in it if the catalogue is away. It goes on when that is
  // back, from its checkpoints.
  while (ReasonOf(status) == "CATALOG_UNAVAILABLE" && !stopping_) {
    Rest(training, name, status);
    done = *operation;
    status = RunProcess(*job.lock, done);
  }
  if (!IsOwn(job)) {
    spdlog::warn("{}: another server goes on with it", name);
    return;
  }
  // Before the end is stored: an operation that has ended has its log.
  const auto id = ParseName(name, "operations");
  KeepLog(name, id->id);
  const bool interrupted = IsInterrupted(status);
  if (stopping_ && (interrupted || absl::IsUnavailable(status))) return;
  const bool may_repeat =
      interrupted && ++interruptions_[training][name] < options_.attempts;
  bool again = false;
  const auto end = [&](Operation& ended) {
    const bool cancelled = ended.state() == Operation::STATE_CANCELLING;
    again = may_repeat && !cancelled;
    if (again) {
      ended.set_state(Operation::STATE_QUEUED);
      return absl::OkStatus();
    }
    ended.set_end_time_ms(now_());
    *ended.mutable_progress() = done.progress();
    if (status.ok()) {
      ended.set_state(Operation::STATE_SUCCEEDED);
      *ended.mutable_result() = done.result();
    } else if (cancelled) {
      ended.set_state(Operation::STATE_CANCELLED);
      *ended.mutable_error() = ToStatusProto(WorkCancelled(name));
    } else {
      ended.set_state(Operation::STATE_FAILED);
      *ended.mutable_error() = ToStatusProto(status);
      // The figures of a comparison that failed the gate.
      if (done.has_result()) *ended.mutable_result() = done.result();
    }
    return absl::OkStatus();
  };
  // A job whose end cannot be stored would be RUNNING for ever.
  auto stored = operations_->Change(name, end, job.lock.get());
  while (!stored.ok() && !stopping_ && !absl::IsAborted(stored.status())) {
    // The room that is missing may be the job's.
    if (!again) RemoveFolder(name);
    Rest(training, name, stored.status());
    stored = operations_->Change(name, end, job.lock.get());
  }
  if (!stored.ok()) return;
  storage_[training].Succeeds();
  if (status.ok()) {
    spdlog::info("{}: succeeded", name);
  } else {
    spdlog::warn("{}: {}{}", name, std::string(status.message()),
                 again ? "; starting it again" : "");
  }
  if (again) return;
  interruptions_[training].erase(name);
  RemoveFolder(name);
  const std::lock_guard lock(mutex_);
  cancelled_.erase(name);
}

void JobQueue::RemoveFolder(const std::string& name) {
  const auto id = ParseName(name, "operations");
  data_->files().RemoveAll(data_->JobPath(id->id)).IgnoreError();
}

absl::Status JobQueue::RunProcess(const Lock& lock, Operation& operation) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName(operation.name(), "operations"));
  const std::string folder = data_->JobPath(name.id);
  TACTUS_ASSIGN_OR_RETURN(const PinnedVersion dataset,
                          WriteSpec(operation, folder));
  TACTUS_ASSIGN_OR_RETURN(const auto run, Start(operation, folder));
  TACTUS_RETURN_IF_ERROR(Follow(lock, operation.name(), *run));
  const JobRun::End end = run->Wait(kPatience);
  if (const auto latest = operations_->Get(operation.name()); latest.ok()) {
    *operation.mutable_progress() = latest->progress();
  }
  if (!end.ok) return Explain(operation.name(), folder, end);
  absl::Status taken = TakeOutcome(lock, folder, operation);
  while (absl::IsUnavailable(taken) && !stopping_) {
    Rest(operation.kind() == Operation::KIND_TRAIN, operation.name(), taken);
    taken = TakeOutcome(lock, folder, operation);
  }
  // A gate may let go of its dataset while it is compared on, and a model may
  // be deleted while it is evaluated.
  return ExplainModels(operation, dataset.Explain(taken));
}

absl::StatusOr<std::unique_ptr<JobRun>> JobQueue::Start(
    const Operation& operation, const std::string& folder) const {
  JobProcess::Options process = options_.process;
  if (operation.kind() == Operation::KIND_TRAIN) {
    if (options_.slurm) return SlurmJob::Start(*options_.slurm, folder);
    process.launcher = options_.training_launcher;
  }
  return JobProcess::Start(process, folder);
}

absl::Status JobQueue::Explain(const std::string& name,
                               const std::string& folder,
                               const JobRun::End& end) const {
  if (end.status == kExitStorageFull) {
    return StorageFull(folder,
                       absl::StrCat("no room for the result of ", name));
  }
  const std::string process = absl::StrCat("the process of ", name, " ");
  if (end.status != kExitOutOfMemory) {
    return JobCrashed(absl::StrCat(process, end.text));
  }
  const int64_t limit = options_.process.memory_bytes;
  return JobCrashed(absl::StrCat(
      process, "ran out of memory",
      limit == 0 ? std::string()
                 : absl::StrCat("; it may have ", limit / kBytesPerMib,
                                " MiB (--job-memory-mb)")));
}

absl::StatusOr<std::string> JobQueue::GiveModel(const std::string& version,
                                                const std::string& file) const {
  TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion model, models_->Get(version));
  if (!model.blob_sha256().empty()) return model.blob_sha256();
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle, models_->Bundle(model));
  TACTUS_RETURN_IF_ERROR(WriteAtomically(data_->files(), file, bundle));
  return "";
}

absl::Status JobQueue::ExplainModels(const Operation& operation,
                                     const absl::Status& status) const {
  if (status.ok()) return status;
  for (const std::string& version : {operation.evaluate().model_version(),
                                     operation.promote().model_version()}) {
    if (version.empty()) continue;
    TACTUS_RETURN_IF_ERROR(models_->Get(version).status());
  }
  return status;
}

absl::StatusOr<PinnedVersion> JobQueue::WriteSpec(
    const Operation& operation, const std::string& folder) const {
  TACTUS_RETURN_IF_ERROR(data_->files().MakeDirectory(folder));
  v1::JobSpec spec;
  *spec.mutable_operation() = operation;
  spec.set_blob_folder(data_->BlobFolder());
  std::string dataset;
  switch (operation.kind()) {
    case Operation::KIND_TRAIN:
      dataset = operation.train().dataset_version();
      break;
    case Operation::KIND_EVALUATE:
      dataset = operation.evaluate().dataset_version();
      if (!operation.evaluate().model_version().empty()) {
        TACTUS_ASSIGN_OR_RETURN(*spec.mutable_model(),
                                GiveModel(operation.evaluate().model_version(),
                                          folder + kCandidateFile));
      }
      break;
    default: {
      const v1::PromoteSpec& promote = operation.promote();
      TACTUS_ASSIGN_OR_RETURN(const v1::Alias alias,
                              models_->GetAlias(promote.alias()));
      dataset = alias.gate().dataset_version();
      spec.mutable_gate()->set_accuracy_margin(alias.gate().accuracy_margin());
      spec.mutable_gate()->set_log_loss_margin(alias.gate().log_loss_margin());
      spec.mutable_gate()->set_calibration_margin(
          alias.gate().calibration_margin());
      TACTUS_ASSIGN_OR_RETURN(
          *spec.mutable_model(),
          GiveModel(promote.model_version(), folder + kCandidateFile));
      TACTUS_ASSIGN_OR_RETURN(
          *spec.mutable_current_model(),
          GiveModel(alias.model_version(), folder + kCurrentFile));
    }
  }
  TACTUS_ASSIGN_OR_RETURN(PinnedVersion version,
                          PinnedVersion::Find(*data_, *datasets_, dataset));
  spec.set_dataset_sha256(version.info().sha256());
  TACTUS_ASSIGN_OR_RETURN(const auto trials, version.Trials());
  for (const v1::TrialInfo& trial : trials) {
    spec.add_trials(trial.sha256());
    spec.add_frames_sha256(trial.frames_sha256());
  }
  TACTUS_RETURN_IF_ERROR(WriteAtomically(data_->files(), folder + "/job.pb",
                                         SerializeDeterministic(spec)));
  return version;
}

absl::Status JobQueue::Follow(const Lock& lock, const std::string& name,
                              JobRun& run) {
  std::vector<v1::LearningPoint> points;
  v1::OperationProgress progress;
  auto stored = steady_clock::now();
  auto phase_begin = stored;
  std::optional<steady_clock::time_point> asked;
  TACTUS_ASSIGN_OR_RETURN(const Operation operation, operations_->Get(name));
  const auto store = [&]() -> absl::Status {
    // Other servers see what is stored.
    if (points.empty() && !data_->is_shared()) return absl::OkStatus();
    stored = steady_clock::now();
    if (!points.empty()) {
      TACTUS_RETURN_IF_ERROR(operations_->AddPoints(name, points, &lock));
      points.clear();
    }
    return operations_
        ->Change(
            name,
            [&](Operation& job) {
              *job.mutable_progress() = progress;
              return absl::OkStatus();
            },
            &lock)
        .status();
  };
  while (true) {
    v1::JobEvent event;
    const JobRun::News news = run.Next(kPoll, &event);
    if (news == JobRun::News::kClosed) break;
    const auto now = steady_clock::now();
    if (news == JobRun::News::kEvent) {
      const int64_t elapsed = now_() - operation.start_time_ms();
      if (event.has_point()) {
        points.push_back(event.point());
        points.back().set_elapsed_ms(elapsed);
      } else {
        if (event.progress().phase() != progress.phase()) phase_begin = now;
        progress = event.progress();
        progress.set_elapsed_ms(elapsed);
        const double fraction = progress.fraction();
        const auto in_phase =
            std::chrono::duration<double, std::milli>(now - phase_begin);
        if (fraction > 0.01) {
          progress.set_remaining_ms(static_cast<int64_t>(
              in_phase.count() * (1 - fraction) / fraction));
        }
        operations_->ShowProgress(name, progress);
      }
    }
    if (now - stored >= options_.store_interval) {
      const absl::Status kept = store();
      // The database may be back soon; what is not stored waits.
      if (!kept.ok() && !absl::IsUnavailable(kept)) return kept;
      if (data_->is_shared()) LookForCancellation(name);
    }
    if (stopping_) run.Terminate(true);
    if (IsCancelled(name)) {
      if (!asked.has_value()) {
        asked = now;
        run.Terminate(false);
      } else if (now - *asked >= kPatience) {
        run.Terminate(true);
      }
    }
  }
  return store();
}

absl::Status JobQueue::TakeOutcome(const Lock& lock, const std::string& folder,
                                   Operation& operation) {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      ReadWhole(data_->files(), folder + "/result.pb", kMaxOutcomeBytes));
  v1::JobOutcome outcome;
  if (!outcome.ParseFromString(bytes)) {
    return DataLost(folder + "/result.pb", "it cannot be parsed");
  }
  if (outcome.has_error()) return FromStatusProto(outcome.error());
  *operation.mutable_result() = outcome.result();
  switch (operation.kind()) {
    case Operation::KIND_TRAIN:
      return Publish(lock, folder, operation);
    case Operation::KIND_PROMOTE:
      return MoveAlias(lock, operation);
    default:
      return absl::OkStatus();
  }
}

absl::Status JobQueue::Publish(const Lock& lock, const std::string& folder,
                               Operation& operation) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle,
                          ReadWhole(data_->files(), folder + "/bundle.tactus",
                                    limits::kMaxBundleBytes));
  TACTUS_ASSIGN_OR_RETURN(
      const v1::DatasetVersion dataset,
      datasets_->Version(operation.train().dataset_version()));
  v1::ModelVersion origin;
  origin.set_operation(operation.name());
  *origin.mutable_train() = operation.train();
  origin.set_dataset_sha256(dataset.sha256());
  origin.set_duration_ms(now_() - operation.start_time_ms());
  origin.set_host(options_.host);
  TACTUS_ASSIGN_OR_RETURN(
      const v1::ModelVersion version,
      models_->AddVersion(operation.train().model(), bundle, origin,
                          {operation.requester(), ""}, &lock));
  operation.mutable_result()->set_model_version(version.name());
  return absl::OkStatus();
}

absl::Status JobQueue::MoveAlias(const Lock& lock, Operation& operation) {
  const v1::Comparison& comparison = operation.result().comparison();
  if (!comparison.passed()) return GateNotPassed(comparison.failure());
  TACTUS_ASSIGN_OR_RETURN(
      const v1::Alias moved,
      models_->Promote(operation.promote(), /*forced=*/false,
                       {operation.requester(), ""},
                       [&](Transaction& change) -> absl::StatusOr<bool> {
                         TACTUS_RETURN_IF_ERROR(lock.StillHeld(change));
                         return true;
                       }));
  *operation.mutable_result()->mutable_lagging_replicas() =
      moved.lagging_replicas();
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
