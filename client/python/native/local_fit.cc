#include "client/python/native/local_fit.h"

#include <algorithm>
#include <optional>

#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/bundle/bundle.h"
#include "core/contacts/contact_set.h"
#include "core/contacts/trained_on.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_record.h"
#include "core/eval/choice_proto.h"
#include "core/eval/chosen_options.h"
#include "core/train/fit.h"
#include "core/train/train_spec.h"
#include "core/train/usable.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal::python {
namespace {

struct TakenContact {
  // Nothing if the trial was never felt.
  std::optional<LabelledContact> contact = {};
  bool without_poses = false;
};

absl::StatusOr<TakenContact> TakeContact(const BorrowedTrial& borrowed,
                                         bool whole_skin) {
  v1::TrialRecord record;
  if (!record.ParseFromString(borrowed.record)) {
    return MalformedRequest(borrowed.record.size());
  }
  record.set_taxels(borrowed.taxels.data(), borrowed.taxels.size());
  TACTUS_ASSIGN_OR_RETURN(const Trial trial, FromRecord(record));
  TakenContact taken = {.without_poses = trial.poses.empty()};
  TACTUS_ASSIGN_OR_RETURN(taken.contact,
                          ExtractContact(trial, {.whole_skin = whole_skin}));
  if (taken.contact) taken.contact->fingerprint = FrameFingerprint(trial);
  return taken;
}

}  // namespace

LocalFit::LocalFit(std::string spec, Options options)
    : spec_(std::move(spec)), options_(std::move(options)) {}

std::pair<std::string, double> LocalFit::Done() const {
  const std::lock_guard lock(mutex_);
  return {phase_, std::min(1.0, fraction_)};
}

void LocalFit::Report(absl::string_view phase, double fraction) {
  const std::lock_guard lock(mutex_);
  if (phase_ != phase) {
    phase_ = std::string(phase);
    fraction_ = 0;
  }
  fraction_ += fraction;
}

absl::StatusOr<LocalFit::Contacts> LocalFit::Read(
    const std::vector<BorrowedTrial>& trials, const ParallelFor& parallel,
    const Progress& progress, bool whole_skin) const {
  const Progress part = progress.Part("read trials", 1);
  const auto count = static_cast<int>(trials.size());
  std::vector<TakenContact> taken(trials.size());
  std::vector<absl::Status> failures(trials.size());
  parallel(count, [&](int i) {
    if (cancelled_) {
      failures[i] = WorkCancelled("the fit");
      return;
    }
    auto contact = TakeContact(trials[i], whole_skin);
    if (contact.ok()) taken[i] = *std::move(contact);
    failures[i] = contact.status();
    part.Add(1.0 / count);
  });
  Contacts contacts;
  for (int i = 0; i < count; ++i) {
    TACTUS_RETURN_IF_ERROR(failures[i]);
    contacts.without_poses |= taken[i].without_poses;
    auto& contact = taken[i].contact;
    if (!contact) continue;
    if (!contacts.felt.empty()) {
      TACTUS_RETURN_IF_ERROR(CheckOneSkin(contacts.felt.front(), *contact));
    }
    contacts.felt.push_back(*std::move(contact));
  }
  if (contacts.felt.empty()) {
    return InvalidTrainingData("the skin feels nothing in any of the trials");
  }
  return contacts;
}

absl::StatusOr<std::string> LocalFit::Run(
    const std::vector<BorrowedTrial>& trials) {
  v1::TrainSpec spec;
  if (!spec.ParseFromString(spec_)) return MalformedRequest(spec_.size());
  TACTUS_RETURN_IF_ERROR(CheckOptions(spec));
  const Progress progress([this](absl::string_view phase, double fraction) {
    Report(phase, fraction);
  });
  const ParallelFor parallel =
      options_.threads > 0 ? OnThreads(options_.threads) : RunOnThreads;
  OptionsRequest request = RequestOf(spec);
  request.cancelled = [this] { return Cancelled(); };
  TACTUS_ASSIGN_OR_RETURN(const Contacts contacts,
                          ReadForFit(request, [&](bool whole_skin) {
                            return Read(trials, parallel, progress, whole_skin);
                          }));
  request.without_poses = contacts.without_poses;
  std::vector<const LabelledContact*> felt;
  for (const LabelledContact& contact : contacts.felt) felt.push_back(&contact);
  TACTUS_ASSIGN_OR_RETURN(const ChosenOptions chosen,
                          ChooseOptions(felt, request, parallel, progress));
  TACTUS_RETURN_IF_ERROR(CheckUsable(chosen.contacts, chosen.options));
  TACTUS_ASSIGN_OR_RETURN(
      Model model, FitModel(chosen.contacts, chosen.options, parallel, progress,
                            /*journal=*/this));
  model.provenance.command = options_.command;
  model.provenance.version = kVersion;
  model.provenance.data = options_.data;
  model.provenance.data_sha256 = DataSha256(felt);
  model.provenance.note = spec.note();
  return EncodeBundle(model);
}

}  // namespace tactus::internal::python
