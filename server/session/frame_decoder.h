// File: frame_decoder.h
//
// FrameDecoder: turns FrameBatch messages into frames of floats, after
// checking everything in them.
//
//   FrameDecoder decoder(settings);
//   TACTUS_RETURN_IF_ERROR(decoder.Check(batch));   // all or nothing
//   for (uint32_t i = 0; i < batch.frame_count(); ++i) {
//     pipeline.Step(decoder.Frame(batch, i));
//   }
//   decoder.Accept(batch);
//
// Of a sparse frame it writes and checks only the listed taxels, and clears
// those that the frame decoded before it had set. Allocates at construction
// only. Not thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "core/skin/frame.h"
#include "server/session/stream_settings.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::server {

class FrameDecoder {
 public:
  explicit FrameDecoder(const StreamSettings& settings);

  // OK if every frame of `batch` may be used after those accepted so far;
  // else the stream's error. Changes nothing that Frame depends on.
  absl::Status Check(const v1::FrameBatch& batch);

  // Frame `index` of the batch that passed Check last; valid until the next
  // call.
  // `missing_before` is left at 0: what counts as a gap is the session's.
  FrameView Frame(const v1::FrameBatch& batch, uint32_t index);

  // Remembers the order of a batch that was used.
  void Accept(const v1::FrameBatch& batch);

  uint64_t last_sequence() const { return last_sequence_.value_or(0); }
  // Frames accepted so far of which only listed taxels were looked at.
  uint64_t sparse_frames() const { return sparse_frames_; }
  int64_t CaptureTime(const v1::FrameBatch& batch, uint32_t index) const;

 private:
  absl::Status CheckOrder(const v1::FrameBatch& batch) const;
  absl::Status CheckSizes(const v1::FrameBatch& batch) const;
  absl::Status CheckSparse(const v1::FrameBatch& batch) const;
  absl::Status CheckPoses(const v1::FrameBatch& batch) const;
  absl::Status CheckValues(const v1::FrameBatch& batch);
  absl::Status CheckListedValues(const v1::FrameBatch& batch) const;

  // Fill taxels_ with the values in the layout's unit. Sparse frames are read
  // one after another: `sparse_entry_` runs along. True if all values are
  // known to be good.
  bool DecodeFrame(const v1::FrameBatch& batch, uint32_t index);
  bool DecodeDense(const v1::FrameBatch& batch, uint32_t index);
  void DecodeSparse(const v1::FrameBatch& batch, uint32_t index);
  float Value(const char* wire) const;
  float SparseValue(const v1::SparseFrames& sparse, size_t entry) const;
  bool Masked(size_t taxel) const {
    return !mask_.empty() && mask_[taxel] == 0;
  }

  size_t taxel_count_;
  v1::TaxelType taxel_type_;
  size_t taxel_bytes_;
  double scale_;
  bool with_poses_;
  double frame_period_ns_;
  // Empty if no taxel is masked, else one byte a taxel, 0 = ignore.
  std::vector<uint8_t> mask_;

  // The frame decoded last.
  std::vector<float> taxels_;
  Pose pose_;
  size_t sparse_entry_ = 0;
  // If it was sparse, the taxels it listed, and no other is set.
  bool skip_unlisted_;
  bool listed_only_ = false;
  std::vector<uint16_t> listed_;
  uint64_t sparse_frames_ = 0;

  std::optional<uint64_t> last_sequence_;
  int64_t last_capture_time_ns_ = 0;
};

}  // namespace tactus::server
