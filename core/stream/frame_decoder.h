// File: frame_decoder.h
//
// FrameDecoder: checks FrameBatch messages and turns them into frames of
// floats.
//
//   FrameDecoder decoder(settings);
//   TACTUS_RETURN_IF_ERROR(decoder.Check(batch));   // all or nothing
//   for (uint32_t i = 0; i < batch.frame_count(); ++i) {
//     pipeline.Step(decoder.Frame(batch, i));
//   }
//   decoder.Accept(batch);
//
// For a sparse frame it writes and checks only the listed values, and clears
// the values that the frame decoded before had set. Allocates only in the
// constructor. Not thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/skin/frame.h"
#include "core/skin/taxel_values.h"
#include "core/stream/stream_settings.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class FrameDecoder {
 public:
  explicit FrameDecoder(const StreamSettings& settings);

  // OK if every frame of `batch` may follow the frames accepted so far; else
  // the stream's error.
  absl::Status Check(const v1::FrameBatch& batch);

  // Frame `index` of the batch that passed Check last, in order from 0; valid
  // until the next call. `missing_before` is 0: the session counts gaps.
  FrameView Frame(const v1::FrameBatch& batch, uint32_t index);

  // Sets the sequence number and time that the next batch must follow.
  void Accept(const v1::FrameBatch& batch);

  uint64_t last_sequence() const { return last_sequence_.value_or(0); }
  // Accepted frames of which only the listed values were written and checked.
  uint64_t sparse_frames() const { return sparse_frames_; }
  int64_t CaptureTime(const v1::FrameBatch& batch, uint32_t index) const;

 private:
  absl::Status CheckOrder(const v1::FrameBatch& batch) const;
  absl::Status CheckSizes(const v1::FrameBatch& batch) const;
  absl::Status CheckSparse(const v1::FrameBatch& batch) const;
  absl::Status CheckPoses(const v1::FrameBatch& batch) const;
  absl::Status CheckValues(const v1::FrameBatch& batch);
  absl::Status CheckListedValues(const v1::FrameBatch& batch) const;

  // True if all values of dense frames are known to be good.
  bool ValuesAreWithin(absl::string_view wire) const;

  // Fill taxels_ with values in the layout's unit. Sparse frames are read in
  // order; `sparse_entry_` is the next entry.
  void DecodeDense(const v1::FrameBatch& batch, uint32_t index);
  void DecodeSparse(const v1::FrameBatch& batch, uint32_t index);
  float SparseValue(const v1::SparseFrames& sparse, size_t entry) const;
  bool Masked(size_t place) const {
    return !mask_.empty() && mask_[place] == 0;
  }
  // The error of the value at `place` of a frame.
  absl::Status BadValue(uint64_t sequence, size_t place, float value) const;

  size_t value_count_;
  int axes_;
  v1::TaxelType taxel_type_;
  size_t taxel_bytes_;
  double scale_;
  bool with_poses_;
  double frame_period_ns_;
  TaxelRange range_;
  // Empty if no taxel is masked, else one byte per value, 0 = ignore.
  std::vector<uint8_t> mask_;

  // The frame decoded last.
  std::vector<float> taxels_;
  Pose pose_;
  size_t sparse_entry_ = 0;
  // If it was sparse: only the values in `listed_` are set.
  bool skip_unlisted_;
  bool listed_only_ = false;
  std::vector<uint16_t> listed_;
  uint64_t sparse_frames_ = 0;

  std::optional<uint64_t> last_sequence_;
  int64_t last_capture_time_ns_ = 0;
};

}  // namespace tactus::internal
