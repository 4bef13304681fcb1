#include "server/contact_log/logged_trial.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/frames/frames_trial.h"
#include "core/data/trial_id.h"
#include "core/data/trial_record.h"
#include "core/stream/frame_decoder.h"
#include "core/stream/stream_settings.h"
#include "server/contact_log/contact_facts.h"

namespace tactus::internal::server {
namespace {

constexpr int kPoseNumbers = 7;
// Memory of a frame beside its taxels while it is made a trial, at the most.
constexpr size_t kFrameCost = 256;

// Divides batches into single dense frames.
class FrameDivider {
 public:
  explicit FrameDivider(const StreamSettings& settings)
      : value_bytes_(settings.taxel_bytes()),
        frame_bytes_(value_bytes_ *
                     static_cast<size_t>(settings.layout.values())),
        period_ns_(settings.frame_period_ns()),
        mask_(ValueMask(settings.layout)) {}

  size_t frame_bytes() const { return frame_bytes_; }

  void Divide(const v1::FrameBatch& batch, std::deque<v1::FrameBatch>& frames) {
    size_t entry = 0;
    for (uint32_t i = 0; i < batch.frame_count(); ++i) {
      v1::FrameBatch& frame = frames.emplace_back();
      frame.set_frame_count(1);
      frame.set_first_sequence(batch.first_sequence() + i);
      frame.set_first_capture_time_ns(
          batch.first_capture_time_ns() +
          static_cast<int64_t>(std::llround(i * period_ns_)));
      if (batch.has_sparse()) {
        Fill(batch.sparse(), i, entry, *frame.mutable_taxels());
      } else {
        frame.set_taxels(batch.taxels().substr(i * frame_bytes_, frame_bytes_));
      }
      ClearMasked(*frame.mutable_taxels());
      if (batch.poses().empty()) continue;
      const auto pose = batch.poses().begin() + int64_t{i} * kPoseNumbers;
      frame.mutable_poses()->Add(pose, pose + kPoseNumbers);
    }
  }

 private:
  // What nobody looks at may be anything, but a trial has numbers only.
  void ClearMasked(std::string& taxels) const {
    for (size_t i = 0; i < mask_.size(); ++i) {
      if (mask_[i] != 0) continue;
      std::memset(taxels.data() + i * value_bytes_, 0, value_bytes_);
    }
  }

  void Fill(const v1::SparseFrames& sparse, uint32_t index, size_t& entry,
            std::string& taxels) const {
    taxels.assign(frame_bytes_, '\0');
    for (uint32_t n = 0; n < sparse.counts(static_cast<int>(index)); ++n) {
      uint16_t place = 0;
      std::memcpy(&place, sparse.indices().data() + entry * sizeof(place),
                  sizeof(place));
      std::memcpy(taxels.data() + place * value_bytes_,
                  sparse.values().data() + entry * value_bytes_, value_bytes_);
      ++entry;
    }
  }

  const size_t value_bytes_;
  const size_t frame_bytes_;
  const double period_ns_;
  // As in FrameDecoder.
  const std::vector<uint8_t> mask_;
};

absl::StatusOr<std::deque<v1::FrameBatch>> FramesOf(
    const v1::Recording& recording, const StreamSettings& settings) {
  FrameDivider divider(settings);
  FrameDecoder decoder(settings);
  uint64_t count = 0;
  for (const v1::FrameBatch& batch : recording.frames()) {
    TACTUS_RETURN_IF_ERROR(decoder.Check(batch));
    decoder.Accept(batch);
    count += batch.frame_count();
  }
  // Sparse frames are small; a trial has them in full.
  const uint64_t bytes = count * divider.frame_bytes();
  if (bytes > limits::kMaxTrialRecordBytes / 2 ||
      count * kFrameCost > limits::kMaxTrialRecordBytes) {
    return InvalidTrial(absl::StrCat("the contact has ", count, " frames of ",
                                     divider.frame_bytes(),
                                     " bytes each, too much for a trial"));
  }
  std::deque<v1::FrameBatch> frames;
  for (const v1::FrameBatch& batch : recording.frames()) {
    divider.Divide(batch, frames);
  }
  if (frames.empty()) return DataLost("a logged contact", "has no frames");
  return frames;
}

// The time of the first frame at or after a sequence number.
double TimeOf(uint64_t sequence, const std::deque<v1::FrameBatch>& frames,
              const Trial& trial) {
  const auto at = std::ranges::lower_bound(frames, sequence, {},
                                           &v1::FrameBatch::first_sequence);
  const auto index = static_cast<size_t>(at - frames.begin());
  return trial.time[std::min(index, frames.size() - 1)];
}

// Where the contact was first.
std::optional<SkinPoint> FirstPlace(const v1::Recording& recording,
                                    uint64_t contact_id) {
  for (const v1::Answer& answer : recording.answers()) {
    for (const v1::Contact& contact : answer.contacts()) {
      if (contact.id() != contact_id || !contact.has_patch()) continue;
      return SkinPoint{contact.patch().centroid_row(),
                       contact.patch().centroid_column()};
    }
  }
  return std::nullopt;
}

}  // namespace

absl::StatusOr<v1::TrialRecord> TrialOf(
    const v1::StoredContacts& stored,
    const std::map<uint32_t, v1::ContactLabel>& labels) {
  TACTUS_ASSIGN_OR_RETURN(const v1::Recording recording, RecordingOf(stored));
  TACTUS_ASSIGN_OR_RETURN(const StreamSettings settings,
                          ParseStreamConfig(stored.stream().config()));
  TACTUS_ASSIGN_OR_RETURN(const auto frames, FramesOf(recording, settings));
  Trial trial =
      TrialOfFrames(frames, settings.taxel_type, settings.scale,
                    settings.pipeline.sample_rate_hz, settings.layout);
  const v1::LoggedContact& first = stored.contacts(0);
  trial.id = SafeTrialId(first.name());
  trial.source = absl::StrCat(first.name(), " of ", first.robot());
  const v1::ContactLabel& main = labels.begin()->second;
  trial.label = main.label();
  trial.object = main.object();
  trial.condition = main.condition();
  trial.material = main.material();
  if (stored.contacts_size() > 1) {
    for (const auto& [place, label] : labels) {
      const auto& contact = stored.contacts(static_cast<int>(place));
      if (contact.onset_sequence() > frames.back().first_sequence()) {
        return InvalidTrial(absl::StrCat(
            contact.name(), " has no frames: it began when those of ",
            first.name(), " were too many to be kept"));
      }
      Touch& touch = trial.touches.emplace_back();
      touch.begin_s = TimeOf(contact.onset_sequence(), frames, trial);
      touch.end_s = TimeOf(contact.end_sequence(), frames, trial);
      touch.label = label.label();
      touch.object = label.object();
      touch.material = label.material();
      touch.centre = FirstPlace(recording, contact.contact_id());
    }
  }
  const v1::TrialRecord record = ToRecord(trial);
  TACTUS_RETURN_IF_ERROR(FromRecord(record).status());
  return record;
}

}  // namespace tactus::internal::server
