// The edits of DatasetStore: other labels, and trials that are left out.
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/trial_record.h"
#include "core/store/records.h"
#include "server/records/dataset_skin.h"
#include "server/records/dataset_store.h"
#include "server/records/request_key.h"
#include "server/records/trial_info.h"
#include "server/records/trial_merge.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal::server {

// An edit of the newest version of a dataset.
struct DatasetStore::Edit {
  // For the key of the request: "relabel" or "remove".
  const char* verb;
  std::string dataset;
  std::vector<std::string> trials;
  std::string from_label;
  // Nothing: the trials are removed.
  std::optional<std::string> label;
  std::string reason;
  std::string request_id;
  // Set for new trials, in place of the other fields.
  const NewTrials* added = nullptr;
};

namespace {

absl::Status CheckText(absl::string_view field, const std::string& text,
                       size_t max_bytes) {
  const std::string fault = text.empty() ? "it must not be empty"
                            : absl::StripAsciiWhitespace(text) != text
                                ? "it must not begin or end with a blank"
                                : TextFault(text, max_bytes);
  if (fault.empty()) return absl::OkStatus();
  return InvalidConfig(field, Quoted(text), fault);
}

// The first ids of the trials, for an error.
std::string FirstNames(const std::vector<v1::TrialInfo>& trials) {
  constexpr size_t kNamed = 5;
  std::string names;
  for (size_t i = 0; i < trials.size() && i < kNamed; ++i) {
    absl::StrAppend(&names, i == 0 ? "" : ", ", trials[i].id());
  }
  return absl::StrCat(names, trials.size() > kNamed ? ", ..." : "");
}

// Indices of the trials that are meant.
absl::StatusOr<std::set<size_t>> Choose(const std::vector<v1::TrialInfo>& held,
                                        const std::vector<std::string>& names,
                                        const std::string& from_label) {
  std::multimap<std::string, size_t> by_name;
  std::set<size_t> chosen;
  for (size_t i = 0; i < held.size(); ++i) {
    if (!from_label.empty() && held[i].label() != from_label) continue;
    if (names.empty()) {
      chosen.insert(i);
      continue;
    }
    by_name.emplace(held[i].id(), i);
    if (!held[i].source().empty()) by_name.emplace(held[i].source(), i);
  }
  for (const std::string& name : names) {
    const auto [begin, end] = by_name.equal_range(name);
    if (begin == end) {
      return InvalidConfig(
          "trial", Quoted(name),
          absl::StrCat("the id or the source of one of the ", held.size(),
                       " trials of the newest version",
                       from_label.empty() ? ""
                                          : absl::StrCat(" with the label ",
                                                         Quoted(from_label)),
                       ": ", FirstNames(held)));
    }
    for (auto it = begin; it != end; ++it) chosen.insert(it->second);
  }
  if (chosen.empty()) {
    return InvalidConfig("from_label", Quoted(from_label),
                         "the label of a trial of the newest version");
  }
  return chosen;
}

}  // namespace

absl::StatusOr<v1::DatasetVersion> DatasetStore::Relabel(
    const v1::RelabelTrialsRequest& request, const Caller& caller) {
  TACTUS_RETURN_IF_ERROR(
      CheckText("label", request.label(), limits::kMaxTrialTextBytes));
  if (request.trials().empty() && request.from_label().empty()) {
    return InvalidConfig("trials and from_label", "both empty",
                         "at least one of the two");
  }
  return Apply({.verb = "relabel",
                .dataset = request.dataset(),
                .trials = {request.trials().begin(), request.trials().end()},
                .from_label = request.from_label(),
                .label = request.label(),
                .reason = request.reason(),
                .request_id = request.request_id()},
               caller);
}

absl::StatusOr<v1::DatasetVersion> DatasetStore::Remove(
    const v1::RemoveTrialsRequest& request, const Caller& caller) {
  if (request.trials().empty()) {
    return InvalidConfig("trials", "empty", "at least one id or source");
  }
  return Apply({.verb = "remove",
                .dataset = request.dataset(),
                .trials = {request.trials().begin(), request.trials().end()},
                .from_label = request.from_label(),
                .label = std::nullopt,
                .reason = request.reason(),
                .request_id = request.request_id()},
               caller);
}

absl::StatusOr<v1::DatasetVersion> DatasetStore::Take(const NewTrials& trials,
                                                      const Caller& caller) {
  return Apply({.verb = "contacts",
                .dataset = trials.dataset,
                .trials = {},
                .from_label = {},
                .label = std::nullopt,
                .reason = trials.reason,
                .request_id = trials.request_id,
                .added = &trials},
               caller);
}

absl::StatusOr<v1::DatasetVersion> DatasetStore::Apply(const Edit& edit,
                                                       const Caller& caller) {
  TACTUS_RETURN_IF_ERROR(
      CheckText("reason", edit.reason, limits::kMaxDescriptionBytes));
  if (edit.trials.size() > limits::kMaxChosenTrials) {
    return InvalidConfig("number of trials", edit.trials.size(),
                         absl::StrCat("at most ", limits::kMaxChosenTrials));
  }
  if (const std::string fault =
          TextFault(edit.request_id, limits::kMaxNameBytes);
      !fault.empty()) {
    return InvalidConfig("request_id", Quoted(edit.request_id), fault);
  }
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  TACTUS_ASSIGN_OR_RETURN(const v1::Dataset dataset, Get(edit.dataset));
  const std::string request = RequestKey(
      absl::StrCat(edit.verb, "/", dataset.name()), caller, edit.request_id);
  if (!edit.request_id.empty()) {
    std::optional<std::string> made;
    TACTUS_RETURN_IF_ERROR(
        data_->catalog().Look([&](const Transaction& look) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(made, look.Get(Table::kRequests, request));
          return absl::OkStatus();
        }));
    // The version of a dataset that was deleted since is gone; its request is a
    // new one.
    if (made.has_value()) {
      auto version = Version(*made);
      if (version.ok() || !absl::IsNotFound(version.status())) return version;
    }
  }
  std::vector<std::string> stored;
  auto version = AddLocked(
      *lock, edit.dataset,
      [&](std::vector<v1::TrialInfo> held) -> absl::StatusOr<Content> {
        auto content = edit.added != nullptr
                           ? Merged(*edit.added, caller, std::move(held))
                           : Edited(edit, caller, std::move(held));
        if (!content.ok()) return content;
        for (const v1::TrialInfo& trial : content->trials) {
          stored.push_back(trial.sha256());
        }
        return content;
      },
      caller.name, caller,
      [&](Transaction& change, const v1::DatasetVersion& made) -> absl::Status {
        TACTUS_RETURN_IF_ERROR(
            CheckStoredBytes(change, quotas_, caller.name, made.added_bytes()));
        if (edit.request_id.empty()) return absl::OkStatus();
        return change.Put(Table::kRequests, request, made.name());
      });
  if (!version.ok()) RemoveUnused(stored);
  return version;
}

absl::StatusOr<DatasetStore::Content> DatasetStore::Edited(
    const Edit& edit, const Caller& caller,
    std::vector<v1::TrialInfo> held) const {
  TACTUS_ASSIGN_OR_RETURN(auto chosen,
                          Choose(held, edit.trials, edit.from_label));
  Content content;
  content.about.set_reason(edit.reason);
  if (!edit.label.has_value()) {
    content.about.set_change(v1::DatasetVersion::CHANGE_REMOVE);
    if (chosen.size() == held.size()) {
      return InvalidConfig("trials", "all of the newest version",
                           "some of them (trainctl datasets delete removes a "
                           "whole dataset)");
    }
    for (size_t i = 0; i < held.size(); ++i) {
      if (!chosen.contains(i)) content.trials.push_back(std::move(held[i]));
    }
    return content;
  }
  content.about.set_change(v1::DatasetVersion::CHANGE_RELABEL);
  std::erase_if(chosen,
                [&](size_t i) { return held[i].label() == *edit.label; });
  if (chosen.empty()) {
    return InvalidConfig("label", Quoted(*edit.label),
                         "another one than the trials have already");
  }
  content.about.set_relabelled(static_cast<uint32_t>(chosen.size()));
  int64_t bytes = 0;
  for (const size_t i : chosen) bytes += held[i].bytes();
  // Nothing is written that would not fit.
  TACTUS_RETURN_IF_ERROR(data_->catalog().Look([&](const Transaction& look) {
    return CheckStoredBytes(look, quotas_, caller.name, bytes);
  }));
  BlobStore::Batch batch = data_->blobs().NewBatch();
  for (const size_t i : chosen) {
    TACTUS_RETURN_IF_ERROR(
        StoreRelabelled(batch, *edit.label, caller, held[i]));
  }
  TACTUS_RETURN_IF_ERROR(batch.Commit());
  content.trials = std::move(held);
  return content;
}

absl::StatusOr<DatasetStore::Content> DatasetStore::Merged(
    const NewTrials& trials, const Caller& caller,
    std::vector<v1::TrialInfo> held) const {
  TACTUS_RETURN_IF_ERROR(data_->reserve().Check());
  DatasetSkin skin(data_->blobs(), trials.dataset, held);
  BlobStore::Batch batch = data_->blobs().NewBatch();
  std::vector<v1::TrialInfo> made;
  int64_t bytes = 0;
  for (size_t i = 0; i < trials.count; ++i) {
    TACTUS_ASSIGN_OR_RETURN(const v1::TrialRecord record, trials.make(i));
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, FromRecord(record));
    TACTUS_RETURN_IF_ERROR(skin.Check(trial));
    const std::string text = SerializeDeterministic(record);
    bytes += static_cast<int64_t>(text.size());
    // Nothing is written that would not fit.
    TACTUS_RETURN_IF_ERROR(data_->catalog().Look([&](const Transaction& look) {
      return CheckStoredBytes(look, quotas_, caller.name, bytes);
    }));
    TACTUS_ASSIGN_OR_RETURN(const std::string sha256, batch.Add(text));
    made.push_back(InfoOf(record, trial, sha256, text.size()));
  }
  AddFingerprints(held);
  TACTUS_ASSIGN_OR_RETURN(TrialMerge merge,
                          MergeTrials(held, made, {.replace_labels = true}));
  TACTUS_RETURN_IF_ERROR(batch.Commit());
  Content content;
  content.trials = std::move(merge.kept);
  content.about.set_change(v1::DatasetVersion::CHANGE_CONTACTS);
  content.about.set_reason(trials.reason);
  content.about.set_relabelled(merge.relabelled);
  content.about.set_renamed(static_cast<uint32_t>(merge.new_ids.size()));
  BlobStore::Batch renamed = data_->blobs().NewBatch();
  for (const size_t i : merge.added) {
    v1::TrialInfo& trial = content.trials.emplace_back(made[i]);
    if (const auto id = merge.new_ids.find(i); id != merge.new_ids.end()) {
      TACTUS_RETURN_IF_ERROR(
          StoreRenamed(data_->blobs(), renamed, id->second, trial));
    }
  }
  TACTUS_RETURN_IF_ERROR(renamed.Commit());
  std::set<std::string> used;
  for (const v1::TrialInfo& trial : content.trials) used.insert(trial.sha256());
  std::vector<std::string> unused;
  for (const v1::TrialInfo& trial : made) {
    if (!used.contains(trial.sha256())) unused.push_back(trial.sha256());
  }
  RemoveUnused(unused);
  return content;
}

absl::Status DatasetStore::StoreRelabelled(BlobStore::Batch& batch,
                                           const std::string& label,
                                           const Caller& caller,
                                           v1::TrialInfo& trial) const {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      data_->blobs().Read(trial.sha256(), limits::kMaxTrialRecordBytes));
  TACTUS_ASSIGN_OR_RETURN(v1::TrialRecord record,
                          StoredTrialRecord(bytes, trial.sha256()));
  if (record.touches_size() > 0) {
    return InvalidTrial(absl::StrCat(
        "trial ", Quoted(trial.id()), " has ", record.touches_size(),
        " touches with a label each, which no relabelling changes; upload it "
        "with other labels instead"));
  }
  v1::Labelling labelling;
  labelling.set_by(caller.name);
  labelling.set_time_ms(now_());
  labelling.set_before(record.label());
  *record.mutable_labelling() = labelling;
  record.set_label(label);
  const std::string relabelled = SerializeDeterministic(record);
  if (relabelled.size() > limits::kMaxTrialRecordBytes) {
    return InvalidTrial(absl::StrCat("trial ", Quoted(trial.id()), " has ",
                                     relabelled.size(),
                                     " bytes with the new label; it must have "
                                     "at most ",
                                     limits::kMaxTrialRecordBytes));
  }
  TACTUS_ASSIGN_OR_RETURN(*trial.mutable_sha256(), batch.Add(relabelled));
  trial.set_bytes(static_cast<int64_t>(relabelled.size()));
  trial.set_label(label);
  *trial.mutable_labelling() = std::move(labelling);
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
