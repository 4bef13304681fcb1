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
#include "core/contacts/copies.h"
#include "core/contacts/trained_on.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_record.h"
#include "core/eval/choice_proto.h"
#include "core/eval/chosen_options.h"
#include "core/eval/evaluate.h"
#include "core/store/blob_store.h"
#include "core/train/fit.h"
#include "core/train/train_spec.h"
#include "core/train/usable.h"
#include "server/trainer/compare.h"
#include "server/trainer/job_files.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {
namespace {

using v1::Operation;

constexpr int64_t kMaxSpecBytes = 256L * 1024 * 1024;

// The contacts of a dataset, and how many trials have none.
struct Contacts {
  std::vector<LabelledContact> felt;
  uint32_t never_felt = 0;
  // Some trial comes from taxels without poses.
  bool without_poses = false;

  std::vector<const LabelledContact*> Pointers() const {
    std::vector<const LabelledContact*> pointers;
    for (const LabelledContact& contact : felt) pointers.push_back(&contact);
    return pointers;
  }
};

struct ReadTrial {
  // Nothing if the trial was never felt.
  std::optional<LabelledContact> contact = {};
  bool without_poses = false;
};

absl::StatusOr<ReadTrial> ReadContact(FileSystem& files,
                                      const v1::JobSpec& spec, int number,
                                      bool whole_skin) {
  const std::string& sha256 = spec.trials(number);
  const std::string path = BlobPath(spec.blob_folder(), sha256);
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      ReadBlobFile(files, path, sha256, limits::kMaxTrialRecordBytes));
  TACTUS_ASSIGN_OR_RETURN(const v1::TrialRecord record,
                          StoredTrialRecord(bytes, path));
  TACTUS_ASSIGN_OR_RETURN(const Trial trial, FromRecord(record));
  ReadTrial read = {.without_poses =
                        !trial.taxels.empty() && trial.poses.empty()};
  TACTUS_ASSIGN_OR_RETURN(read.contact,
                          ExtractContact(trial, {.whole_skin = whole_skin}));
  if (read.contact.has_value()) {
    const bool known = number < spec.frames_sha256_size() &&
                       !spec.frames_sha256(number).empty();
    read.contact->fingerprint =
        known ? spec.frames_sha256(number) : FrameFingerprint(trial);
  }
  return read;
}

// The contacts are in the order of the trials, whatever the threads do.
absl::StatusOr<Contacts> ReadContacts(FileSystem& files,
                                      const v1::JobSpec& spec,
                                      const JobThreads& threads,
                                      const Progress& progress,
                                      bool whole_skin = true) {
  const Progress part = progress.Part("read trials", 1);
  const int count = spec.trials_size();
  std::vector<ReadTrial> read(count);
  std::vector<absl::Status> failures(count);
  threads.start(count, [&](int i) {
    auto trial = ReadContact(files, spec, i, whole_skin);
    if (trial.ok()) read[i] = *std::move(trial);
    failures[i] = trial.status();
    part.Add(1.0 / count);
  });
  Contacts contacts;
  for (int i = 0; i < count; ++i) {
    TACTUS_RETURN_IF_ERROR(failures[i]);
    contacts.without_poses |= read[i].without_poses;
    auto& contact = read[i].contact;
    if (!contact.has_value()) {
      ++contacts.never_felt;
      continue;
    }
    if (!contacts.felt.empty()) {
      TACTUS_RETURN_IF_ERROR(CheckOneSkin(contacts.felt.front(), *contact));
    }
    contacts.felt.push_back(*std::move(contact));
  }
  if (contacts.felt.empty()) {
    return InvalidTrainingData("no trial of the dataset has a contact");
  }
  return contacts;
}

// Names the contacts that have the frames of an earlier one.
void AddDuplicates(const std::vector<const LabelledContact*>& contacts,
                   v1::OperationResult& result) {
  const std::vector<Copy> copies = FindCopies(contacts);
  result.set_duplicates(static_cast<uint32_t>(copies.size()));
  for (size_t i = 0; i < copies.size() && i < limits::kMaxNamedTrials; ++i) {
    const LabelledContact& contact = *contacts[copies[i].contact];
    const LabelledContact& first = *contacts[copies[i].first];
    v1::DuplicateTrial& duplicate = *result.add_duplicate_trials();
    duplicate.set_name(ContactName(contact));
    duplicate.set_label(contact.label);
    duplicate.set_first_name(ContactName(first));
    duplicate.set_first_label(first.label);
  }
}

void AddUnusable(const std::vector<std::string>& names,
                 v1::OperationResult& result) {
  result.set_unusable(static_cast<uint32_t>(names.size()));
  for (size_t i = 0; i < names.size() && i < limits::kMaxNamedTrials; ++i) {
    result.add_unusable_trials(names[i]);
  }
}

// What provenance calls the data of a job.
std::string DataName(const std::string& dataset_version,
                     const v1::JobSpec& spec) {
  return absl::StrCat(dataset_version, " ", spec.dataset_sha256());
}

// The contacts, with what models of the spec can use of them.
absl::StatusOr<Contacts> ReadForSpec(FileSystem& files, const v1::JobSpec& spec,
                                     const v1::TrainSpec& train,
                                     const JobThreads& threads,
                                     const Progress& progress) {
  return ReadForFit(RequestOf(train), [&](bool whole_skin) {
    return ReadContacts(files, spec, threads, progress, whole_skin);
  });
}

// The options that the spec asks for, and the contacts to fit models to.
absl::StatusOr<ChosenOptions> Choose(const v1::TrainSpec& spec,
                                     const Contacts& contacts,
                                     const ParallelFor& parallel,
                                     const Progress& progress,
                                     v1::OperationResult& result,
                                     std::optional<Protocol> protocol = {},
                                     Ranks* ranks = nullptr) {
  OptionsRequest request = RequestOf(spec);
  request.without_poses = contacts.without_poses;
  request.protocol = protocol;
  TACTUS_ASSIGN_OR_RETURN(
      ChosenOptions chosen,
      ChooseOptions(contacts.Pointers(), request, parallel, progress, ranks));
  TACTUS_RETURN_IF_ERROR(CheckUsable(chosen.contacts, chosen.options));
  AddUnusable(chosen.unusable, result);
  if (chosen.choice) *result.mutable_preset_choice() = ToProto(*chosen.choice);
  AddDuplicates(chosen.contacts, result);
  return chosen;
}

absl::Status Train(FileSystem& files, const std::string& folder,
                   const v1::JobSpec& spec, const JobThreads& threads,
                   EventWriter* events, FileJournal* journal, Team& team,
                   v1::OperationResult& result) {
  const v1::TrainSpec& train = spec.operation().train();
  TACTUS_RETURN_IF_ERROR(CheckOptions(train));
  TACTUS_ASSIGN_OR_RETURN(
      const Contacts contacts,
      ReadForSpec(files, spec, train, threads, events->common_progress()));
  TACTUS_ASSIGN_OR_RETURN(const ChosenOptions chosen,
                          Choose(train, contacts, threads.run,
                                 events->progress(), result, {}, &team));
  TACTUS_ASSIGN_OR_RETURN(
      Model model, FitModel(chosen.contacts, chosen.options, threads.run,
                            events->progress(), journal, threads.start, &team));
  if (team.rank() > 0) return absl::OkStatus();
  // Nothing that differs between two runs of one job: its bundle has the same
  // bytes however often the job was interrupted.
  model.provenance.command = absl::StrCat("train ", spec.operation().name());
  model.provenance.version = kVersion;
  model.provenance.data = DataName(train.dataset_version(), spec);
  model.provenance.data_sha256 = DataSha256(contacts.Pointers());
  model.provenance.note = train.note();
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle, EncodeBundle(model));
  return WriteAtomically(files, folder + "/bundle.tactus", bundle);
}

// An evaluation of a bundle, and which of its contacts the model knows.
struct BundleEvaluation {
  Evaluation evaluation;
  TrainedOn trained;
};

// The bundle is the blob `sha256` or, if that is empty, `file`.
absl::StatusOr<BundleEvaluation> EvaluateBundle(
    FileSystem& files, const std::string& sha256, const std::string& file,
    const std::vector<const LabelledContact*>& contacts,
    const std::string& dataset_version, const v1::JobSpec& spec,
    const ParallelFor& parallel, EventWriter* events) {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bundle,
      sha256.empty() ? ReadWhole(files, file, limits::kMaxBundleBytes)
                     : ReadBlobFile(files, BlobPath(spec.blob_folder(), sha256),
                                    sha256, limits::kMaxBundleBytes));
  TACTUS_ASSIGN_OR_RETURN(const auto model, DecodeBundle(bundle));
  for (const LabelledContact* contact : contacts) {
    TACTUS_RETURN_IF_ERROR(CheckFits(*contact, model->model()));
  }
  BundleEvaluation result;
  result.trained = FindTrainedOn(model->model().provenance, contacts,
                                 {.sha256 = DataSha256(contacts),
                                  .name = DataName(dataset_version, spec)});
  TACTUS_ASSIGN_OR_RETURN(
      result.evaluation,
      EvaluateModel(model, contacts,
                    ServedAlgorithm(!model->model().lstms.empty()), parallel,
                    events->progress()));
  return result;
}

absl::Status Evaluate(FileSystem& files, const std::string& folder,
                      const v1::JobSpec& spec, const JobThreads& threads,
                      EventWriter* events, v1::OperationResult& result) {
  const v1::EvaluateSpec& evaluate = spec.operation().evaluate();
  TACTUS_RETURN_IF_ERROR(CheckOptions(evaluate.train()));
  const bool fits = evaluate.model_version().empty();
  TACTUS_ASSIGN_OR_RETURN(
      const Contacts contacts,
      fits ? ReadForSpec(files, spec, evaluate.train(), threads,
                         events->progress())
           : ReadContacts(files, spec, threads, events->progress()));
  v1::EvaluationReport& report = *result.mutable_evaluation();
  if (fits) {
    TACTUS_ASSIGN_OR_RETURN(const Protocol protocol,
                            ParseProtocol(evaluate.protocol()));
    TACTUS_ASSIGN_OR_RETURN(const ChosenOptions chosen,
                            Choose(evaluate.train(), contacts, threads.run,
                                   events->progress(), result, protocol));
    TACTUS_ASSIGN_OR_RETURN(
        const Evaluation evaluation,
        EvaluateProtocol(chosen.contacts, protocol,
                         ServedAlgorithm(chosen.options.lstm.networks > 0),
                         chosen.options, threads.run, events->progress()));
    report = ReportOf(evaluation, contacts.never_felt);
    AddWrongAnswers(evaluation, chosen.contacts, report);
    // The folds see to it.
    report.set_trained_on_data(false);
    return absl::OkStatus();
  }
  const auto tested = contacts.Pointers();
  TACTUS_ASSIGN_OR_RETURN(
      const BundleEvaluation of_bundle,
      EvaluateBundle(files, spec.model(), folder + kCandidateFile, tested,
                     evaluate.dataset_version(), spec, threads.run, events));
  report = ReportOf(of_bundle.evaluation, contacts.never_felt);
  AddWrongAnswers(of_bundle.evaluation, tested, report);
  AddTrainedOn(of_bundle.trained, report);
  AddDuplicates(tested, result);
  return absl::OkStatus();
}

absl::Status ComparePair(FileSystem& files, const std::string& folder,
                         const v1::JobSpec& spec, const JobThreads& threads,
                         EventWriter* events, v1::OperationResult& result) {
  TACTUS_ASSIGN_OR_RETURN(
      const Contacts contacts,
      ReadContacts(files, spec, threads, events->progress()));
  const auto used = contacts.Pointers();
  // A gate's data has no other name than its bytes.
  const auto evaluate = [&](const std::string& sha256, const char* file) {
    return EvaluateBundle(files, sha256, folder + file, used, "", spec,
                          threads.run, events);
  };
  TACTUS_ASSIGN_OR_RETURN(const BundleEvaluation current,
                          evaluate(spec.current_model(), kCurrentFile));
  TACTUS_ASSIGN_OR_RETURN(const BundleEvaluation candidate,
                          evaluate(spec.model(), kCandidateFile));
  v1::Comparison& comparison = *result.mutable_comparison();
  comparison = Compare(current.evaluation, candidate.evaluation,
                       contacts.never_felt, spec.gate());
  AddTrainedOn(current.trained, *comparison.mutable_current());
  AddTrainedOn(candidate.trained, *comparison.mutable_candidate());
  AddDuplicates(used, result);
  return absl::OkStatus();
}

}  // namespace

absl::Status RunJob(FileSystem& files, const std::string& folder,
                    const JobThreads& threads, EventWriter* events,
                    FileJournal* journal, Team& team) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadWhole(files, folder + "/job.pb", kMaxSpecBytes));
  v1::JobSpec spec;
  if (!spec.ParseFromString(bytes)) {
    return DataLost(folder + "/job.pb", "it cannot be parsed");
  }
  v1::JobOutcome outcome;
  v1::OperationResult result;
  absl::Status status;
  const Operation::Kind kind = spec.operation().kind();
  if (kind == Operation::KIND_TRAIN) {
    status = Train(files, folder, spec, threads, events, journal, team, result);
  } else if (team.rank() == 0) {
    status = kind == Operation::KIND_EVALUATE
                 ? Evaluate(files, folder, spec, threads, events, result)
                 : ComparePair(files, folder, spec, threads, events, result);
  }
  // What ends one rank ends the job of all.
  absl::StatusOr<std::string> mine = std::string();
  if (!status.ok()) mine = status;
  status = team.Exchange(mine).status();
  if (team.rank() > 0) return absl::OkStatus();
  if (status.ok()) {
    *outcome.mutable_result() = std::move(result);
  } else {
    *outcome.mutable_error() = ToStatusProto(status);
  }
  return WriteAtomically(files, folder + "/result.pb",
                         SerializeDeterministic(outcome));
}

}  // namespace tactus::internal::server
