#include "server/trainer/job.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/base/status_proto.h"
#include "core/base/version.h"
#include "core/bundle/bundle.h"
#include "core/contacts/contact_set.h"
#include "core/data/trial_record.h"
#include "core/eval/evaluate.h"
#include "core/store/blob_store.h"
#include "core/train/fit.h"
#include "core/train/train_spec.h"
#include "core/train/usable.h"
#include "server/trainer/compare.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::server {
namespace {

using v1::Operation;

constexpr int64_t kMaxSpecBytes = 256L * 1024 * 1024;

// The contacts of a dataset, and how many trials have none.
struct Contacts {
  std::vector<LabelledContact> felt;
  uint32_t never_felt = 0;

  std::vector<const LabelledContact*> Pointers() const {
    std::vector<const LabelledContact*> pointers;
    for (const LabelledContact& contact : felt) pointers.push_back(&contact);
    return pointers;
  }
};

// Nothing if the trial was never felt.
absl::StatusOr<std::optional<LabelledContact>> ReadContact(
    FileSystem& files, const v1::JobSpec& spec, const std::string& sha256) {
  const std::string path =
      absl::StrCat(spec.blob_folder(), "/",
                   absl::string_view(sha256).substr(0, 2), "/", sha256);
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      ReadBlobFile(files, path, sha256, limits::kMaxTrialRecordBytes));
  v1::TrialRecord record;
  if (!record.ParseFromString(bytes)) {
    return DataLost(path, "the trial cannot be parsed");
  }
  TACTUS_ASSIGN_OR_RETURN(const Trial trial, FromRecord(record));
  return ExtractContact(trial);
}

// The contacts are in the order of the trials, whatever the threads do.
absl::StatusOr<Contacts> ReadContacts(FileSystem& files,
                                      const v1::JobSpec& spec,
                                      const ParallelFor& parallel,
                                      const Progress& progress) {
  const Progress part = progress.Part("read trials", 1);
  const int count = spec.trials_size();
  std::vector<std::optional<LabelledContact>> read(count);
  std::vector<absl::Status> failures(count);
  parallel(count, [&](int i) {
    auto contact = ReadContact(files, spec, spec.trials(i));
    if (contact.ok()) read[i] = *std::move(contact);
    failures[i] = contact.status();
    part.Add(1.0 / count);
  });
  Contacts contacts;
  for (int i = 0; i < count; ++i) {
    TACTUS_RETURN_IF_ERROR(failures[i]);
    if (!read[i].has_value()) {
      ++contacts.never_felt;
      continue;
    }
    if (!contacts.felt.empty()) {
      TACTUS_RETURN_IF_ERROR(CheckOneSkin(contacts.felt.front(), *read[i]));
    }
    contacts.felt.push_back(*std::move(read[i]));
  }
  if (contacts.felt.empty()) {
    return InvalidTrainingData("no trial of the dataset has a contact");
  }
  return contacts;
}

// Leaves contacts out that models cannot be fitted to, or refuses them.
absl::Status SelectUsable(const v1::TrainSpec& spec, const FitOptions& options,
                          std::vector<const LabelledContact*>& contacts,
                          v1::OperationResult& result) {
  if (!spec.skip_unusable()) return CheckUsable(contacts, options);
  std::erase_if(contacts, [&](const LabelledContact* contact) {
    if (IsUsable(*contact, options)) return false;
    result.add_unusable_trials(contact->id);
    return true;
  });
  return absl::OkStatus();
}

absl::Status Train(FileSystem& files, const std::string& folder,
                   const v1::JobSpec& spec, const ParallelFor& parallel,
                   EventWriter* events, FileJournal* journal,
                   v1::OperationResult& result) {
  const v1::TrainSpec& train = spec.operation().train();
  TACTUS_ASSIGN_OR_RETURN(const FitOptions options, OptionsOf(train));
  TACTUS_ASSIGN_OR_RETURN(
      const Contacts contacts,
      ReadContacts(files, spec, parallel, events->progress()));
  auto used = contacts.Pointers();
  TACTUS_RETURN_IF_ERROR(SelectUsable(train, options, used, result));
  TACTUS_ASSIGN_OR_RETURN(Model model, FitModel(used, options, parallel,
                                                events->progress(), journal));
  // Nothing that differs between two runs of one job: its bundle has the same
  // bytes however often the job was interrupted.
  model.provenance.command = absl::StrCat("train ", spec.operation().name());
  model.provenance.version = kVersion;
  model.provenance.data =
      absl::StrCat(train.dataset_version(), " ", spec.dataset_sha256());
  model.provenance.note = train.note();
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle, EncodeBundle(model));
  return WriteAtomically(files, folder + "/bundle.tactus", bundle);
}

absl::StatusOr<Evaluation> EvaluateBundle(
    FileSystem& files, const std::string& path,
    const std::vector<const LabelledContact*>& contacts,
    const ParallelFor& parallel, EventWriter* events) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle,
                          ReadWhole(files, path, limits::kMaxBundleBytes));
  TACTUS_ASSIGN_OR_RETURN(const auto model, DecodeBundle(bundle));
  for (const LabelledContact* contact : contacts) {
    TACTUS_RETURN_IF_ERROR(CheckFits(*contact, model->model()));
  }
  return EvaluateModel(model, contacts,
                       ServedAlgorithm(!model->model().lstms.empty()), parallel,
                       events->progress());
}

absl::Status Evaluate(FileSystem& files, const std::string& folder,
                      const v1::JobSpec& spec, const ParallelFor& parallel,
                      EventWriter* events, v1::OperationResult& result) {
  const v1::EvaluateSpec& evaluate = spec.operation().evaluate();
  TACTUS_ASSIGN_OR_RETURN(
      const Contacts contacts,
      ReadContacts(files, spec, parallel, events->progress()));
  auto used = contacts.Pointers();
  absl::StatusOr<Evaluation> evaluation;
  if (evaluate.model_version().empty()) {
    TACTUS_ASSIGN_OR_RETURN(const FitOptions options,
                            OptionsOf(evaluate.train()));
    TACTUS_ASSIGN_OR_RETURN(const Protocol protocol,
                            ParseProtocol(evaluate.protocol()));
    TACTUS_RETURN_IF_ERROR(
        SelectUsable(evaluate.train(), options, used, result));
    evaluation = EvaluateProtocol(used, protocol,
                                  ServedAlgorithm(options.lstm.networks > 0),
                                  options, parallel, events->progress());
  } else {
    evaluation = EvaluateBundle(files, folder + "/candidate.tactus", used,
                                parallel, events);
  }
  TACTUS_RETURN_IF_ERROR(evaluation.status());
  *result.mutable_evaluation() = ReportOf(*evaluation, contacts.never_felt);
  return absl::OkStatus();
}

absl::Status ComparePair(FileSystem& files, const std::string& folder,
                         const v1::JobSpec& spec, const ParallelFor& parallel,
                         EventWriter* events, v1::OperationResult& result) {
  TACTUS_ASSIGN_OR_RETURN(
      const Contacts contacts,
      ReadContacts(files, spec, parallel, events->progress()));
  const auto used = contacts.Pointers();
  TACTUS_ASSIGN_OR_RETURN(const Evaluation current,
                          EvaluateBundle(files, folder + "/current.tactus",
                                         used, parallel, events));
  TACTUS_ASSIGN_OR_RETURN(const Evaluation candidate,
                          EvaluateBundle(files, folder + "/candidate.tactus",
                                         used, parallel, events));
  *result.mutable_comparison() =
      Compare(current, candidate, contacts.never_felt, spec.gate());
  return absl::OkStatus();
}

}  // namespace

absl::Status RunJob(FileSystem& files, const std::string& folder,
                    const ParallelFor& parallel, EventWriter* events,
                    FileJournal* journal) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadWhole(files, folder + "/job.pb", kMaxSpecBytes));
  v1::JobSpec spec;
  if (!spec.ParseFromString(bytes)) {
    return DataLost(folder + "/job.pb", "it cannot be parsed");
  }
  v1::JobOutcome outcome;
  v1::OperationResult result;
  absl::Status status;
  switch (spec.operation().kind()) {
    case Operation::KIND_TRAIN:
      status = Train(files, folder, spec, parallel, events, journal, result);
      break;
    case Operation::KIND_EVALUATE:
      status = Evaluate(files, folder, spec, parallel, events, result);
      break;
    default:
      status = ComparePair(files, folder, spec, parallel, events, result);
  }
  if (status.ok()) {
    *outcome.mutable_result() = std::move(result);
  } else {
    *outcome.mutable_error() = ToStatusProto(status);
  }
  return WriteAtomically(files, folder + "/result.pb",
                         SerializeDeterministic(outcome));
}

}  // namespace tactus::server
