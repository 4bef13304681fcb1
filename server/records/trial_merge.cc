#include "server/records/trial_merge.h"

#include <set>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/text.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_id.h"

namespace tactus::internal::server {
namespace {

// "trial 000002 (pad_17.csv)".
std::string NameOf(const v1::TrialInfo& trial) {
  return absl::StrCat("trial ", Quoted(trial.id()),
                      trial.source().empty()
                          ? ""
                          : absl::StrCat(" (", Quoted(trial.source()), ")"));
}

absl::Status TwoLabels(const v1::TrialInfo& trial, const v1::TrialInfo& other,
                       absl::string_view where, absl::string_view advice) {
  return InvalidTrial(absl::StrCat(
      NameOf(trial), ": label: is ", Quoted(trial.label()), "; ", NameOf(other),
      " ", where, " has the same frames and the label ", Quoted(other.label()),
      ": ", advice));
}

class Merger {
 public:
  Merger(const std::vector<v1::TrialInfo>& held,
         const std::vector<v1::TrialInfo>& uploaded,
         const MergeOptions& options)
      : held_(held), uploaded_(uploaded), options_(options) {
    for (size_t i = 0; i < held.size(); ++i) {
      records_.emplace(held[i].sha256(), &held[i]);
      if (IdentifiesRecording(held[i].frames_sha256())) {
        held_by_frames_[held[i].frames_sha256()].push_back(i);
      }
    }
  }

  absl::StatusOr<TrialMerge> Run() {
    for (size_t i = 0; i < uploaded_.size(); ++i) {
      if (const absl::Status status = Take(i); !status.ok()) return status;
    }
    TrialIds ids;
    std::map<std::string, const v1::TrialInfo*> owners;
    for (size_t i = 0; i < held_.size(); ++i) {
      if (replaced_.contains(i)) continue;
      merge_.kept.push_back(held_[i]);
      ids.Add(held_[i].id());
      owners.emplace(held_[i].id(), &held_[i]);
    }
    for (const size_t i : merge_.added) {
      const v1::TrialInfo& trial = uploaded_[i];
      const std::string id = ids.Unique(trial.id());
      if (id != trial.id()) {
        merge_.new_ids[i] = id;
        v1::TrialNote* note =
            Note(v1::TrialNote::KIND_RENAMED, trial, *owners.at(trial.id()));
        if (note != nullptr) note->set_new_id(id);
      }
      owners.emplace(id, &trial);
    }
    return std::move(merge_);
  }

 private:
  absl::Status Take(size_t i) {
    const v1::TrialInfo& trial = uploaded_[i];
    const std::string& frames = trial.frames_sha256();
    // The very same record.
    const auto [record, new_record] = records_.emplace(trial.sha256(), &trial);
    if (!new_record) {
      LeaveOut(trial, *record->second);
      return absl::OkStatus();
    }
    if (!IdentifiesRecording(frames)) {
      merge_.added.push_back(i);
      return absl::OkStatus();
    }
    const auto [same, first] = uploaded_by_frames_.emplace(frames, i);
    if (!first) {
      const v1::TrialInfo& other = uploaded_[same->second];
      if (other.label() != trial.label()) {
        return TwoLabels(trial, other, "of the same upload",
                         "upload one of the two");
      }
      LeaveOut(trial, other);
      return absl::OkStatus();
    }
    const auto held = held_by_frames_.find(frames);
    if (held == held_by_frames_.end()) {
      merge_.added.push_back(i);
      return absl::OkStatus();
    }
    return options_.replace_labels ? Replace(i, held->second)
                                   : Compare(trial, held->second);
  }

  // The recording is held already.
  absl::Status Compare(const v1::TrialInfo& trial,
                       const std::vector<size_t>& held) {
    for (const size_t h : held) {
      if (held_[h].label() != trial.label()) continue;
      LeaveOut(trial, held_[h]);
      return absl::OkStatus();
    }
    return TwoLabels(trial, held_[held.front()], "of the dataset",
                     "take the new label with replace_labels (trainctl "
                     "datasets upload --replace-labels), or leave the trial "
                     "out");
  }

  absl::Status Replace(size_t i, const std::vector<size_t>& held) {
    const v1::TrialInfo& trial = uploaded_[i];
    replaced_.insert(held.begin(), held.end());
    merge_.added.push_back(i);
    const v1::TrialInfo* other = &held_[held.front()];
    for (const size_t h : held) {
      if (held_[h].label() != trial.label()) other = &held_[h];
    }
    merge_.relabelled += other->label() != trial.label();
    Note(v1::TrialNote::KIND_REPLACED, trial, *other);
    return absl::OkStatus();
  }

  void LeaveOut(const v1::TrialInfo& trial, const v1::TrialInfo& other) {
    ++merge_.duplicates;
    Note(v1::TrialNote::KIND_DUPLICATE, trial, other);
  }

  // Null after the last note that is kept.
  v1::TrialNote* Note(v1::TrialNote::Kind kind, const v1::TrialInfo& trial,
                      const v1::TrialInfo& other) {
    if (merge_.notes.size() >= limits::kMaxTrialNotes) return nullptr;
    v1::TrialNote& note = merge_.notes.emplace_back();
    note.set_kind(kind);
    note.set_id(trial.id());
    note.set_source(trial.source());
    note.set_label(trial.label());
    note.set_other_id(other.id());
    note.set_other_source(other.source());
    note.set_other_label(other.label());
    return &note;
  }

  const std::vector<v1::TrialInfo>& held_;
  const std::vector<v1::TrialInfo>& uploaded_;
  const MergeOptions options_;
  // The trials that are there, by the SHA-256 of their records.
  std::map<std::string, const v1::TrialInfo*> records_;
  // Indices by fingerprint.
  std::map<std::string, std::vector<size_t>> held_by_frames_;
  std::map<std::string, size_t> uploaded_by_frames_;
  // Indices of held trials.
  std::set<size_t> replaced_;
  TrialMerge merge_;
};

}  // namespace

absl::StatusOr<TrialMerge> MergeTrials(
    const std::vector<v1::TrialInfo>& held,
    const std::vector<v1::TrialInfo>& uploaded, const MergeOptions& options) {
  return Merger(held, uploaded, options).Run();
}

}  // namespace tactus::internal::server
