#include "server/records/dataset_skin.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/text.h"
#include "core/data/trial_id.h"
#include "core/data/trial_record.h"

namespace tactus::internal::server {

DatasetSkin::DatasetSkin(const BlobStore& blobs, const std::string& dataset,
                         const std::vector<v1::TrialInfo>& held) {
  for (const v1::TrialInfo& info : held) {
    // Labels are taken although a trial is damaged; a training names it.
    const auto bytes = blobs.Read(info.sha256(), limits::kMaxTrialRecordBytes);
    if (!bytes.ok()) continue;
    const auto record = StoredTrialRecord(*bytes, info.sha256());
    if (!record.ok()) continue;
    const auto trial = FromRecord(*record);
    if (!trial.ok()) continue;
    shared_ = SharedOf(
        *trial,
        absl::StrCat("trial ", Quoted(TrialName(info.id(), info.source())),
                     " of ", dataset));
    return;
  }
}

absl::Status DatasetSkin::Check(const Trial& trial) {
  const Shared own = SharedOf(
      trial, absl::StrCat("trial ", Quoted(TrialName(trial.id, trial.source))));
  if (!shared_.has_value()) {
    shared_ = own;
    return absl::OkStatus();
  }
  std::string difference;
  if (own.layout.has_value() != shared_->layout.has_value()) {
    difference = own.layout.has_value() ? "taxels, not ideal signals"
                                        : "ideal signals, not taxels";
  } else if (own.layout.has_value()) {
    difference = SkinDifference(*own.layout, *shared_->layout);
  }
  if (difference.empty() && own.sample_rate_hz != shared_->sample_rate_hz) {
    difference = absl::StrCat("sample_rate_hz ", own.sample_rate_hz, ", not ",
                              shared_->sample_rate_hz);
  }
  if (difference.empty()) return absl::OkStatus();
  return InvalidTrial(absl::StrCat(
      own.trial, " is of ", Text(own), ", but ", shared_->trial, " is of ",
      Text(*shared_), ": it has ", difference,
      ". The trials of a dataset must have one skin and one rate: take another "
      "dataset"));
}

DatasetSkin::Shared DatasetSkin::SharedOf(const Trial& trial,
                                          const std::string& name) {
  return {.trial = name,
          .layout = trial.skin,
          .sample_rate_hz = trial.sample_rate_hz};
}

std::string DatasetSkin::Text(const Shared& shared) {
  if (!shared.layout.has_value()) return "ideal signals";
  const SkinLayout& layout = *shared.layout;
  return absl::StrCat("the skin ", Quoted(layout.name), " (", layout.rows, "x",
                      layout.columns, " taxels, ", shared.sample_rate_hz,
                      " frames per second)");
}

}  // namespace tactus::internal::server
