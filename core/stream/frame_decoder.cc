#include "core/stream/frame_decoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "wire values are copied as they are");

// Numbers a frame: x y z qx qy qz qw.
constexpr int kPoseSize = 7;

template <typename Type>
Type Load(const char* bytes) {
  Type value;
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

uint16_t SparseIndex(const v1::SparseFrames& sparse, size_t entry) {
  return Load<uint16_t>(sparse.indices().data() + 2 * entry);
}

TaxelRange RangeOf(const SkinLayout& layout) {
  return {layout.signed_values ? -limits::kMaxTaxelValue : 0,
          limits::kMaxTaxelValue};
}

}  // namespace

FrameDecoder::FrameDecoder(const StreamSettings& settings)
    : value_count_(settings.layout.values()),
      axes_(settings.layout.axes),
      taxel_type_(settings.taxel_type),
      taxel_bytes_(settings.taxel_bytes()),
      scale_(settings.scale),
      with_poses_(settings.with_poses),
      frame_period_ns_(settings.frame_period_ns()),
      range_(RangeOf(settings.layout)),
      mask_(ValueMask(settings.layout)),
      taxels_(value_count_, 0.0F),
      skip_unlisted_(settings.pipeline.skip[SkipRule::kUnlistedTaxels]) {
  listed_.reserve(value_count_);
}

absl::Status FrameDecoder::Check(const v1::FrameBatch& batch) {
  if (batch.frame_count() < 1 ||
      batch.frame_count() > limits::kMaxFramesPerMessage) {
    return FrameCountOutOfRange(batch.frame_count(),
                                limits::kMaxFramesPerMessage);
  }
  TACTUS_RETURN_IF_ERROR(CheckOrder(batch));
  TACTUS_RETURN_IF_ERROR(CheckSizes(batch));
  TACTUS_RETURN_IF_ERROR(CheckPoses(batch));
  return CheckValues(batch);
}

absl::Status FrameDecoder::CheckOrder(const v1::FrameBatch& batch) const {
  const uint64_t sequence = batch.first_sequence();
  const int64_t time = batch.first_capture_time_ns();
  if (last_sequence_ && sequence <= *last_sequence_) {
    return SequenceRegression(sequence, *last_sequence_);
  }
  // Room for the sequence numbers of this batch's frames.
  constexpr uint64_t kLargest = std::numeric_limits<uint64_t>::max();
  if (sequence > kLargest - limits::kMaxFramesPerMessage) {
    return InvalidValue(
        v1::ERROR_REASON_SEQUENCE_REGRESSION, "first_sequence", sequence,
        absl::StrCat("at most ", kLargest - limits::kMaxFramesPerMessage));
  }
  if (time > limits::kMaxCaptureTimeNs || time < -limits::kMaxCaptureTimeNs) {
    return InvalidValue(
        v1::ERROR_REASON_TIME_REGRESSION, "first_capture_time_ns", time,
        absl::StrCat("within ", limits::kMaxCaptureTimeNs, " of 0"));
  }
  if (last_sequence_ && time <= last_capture_time_ns_) {
    return TimeRegression(sequence, time, last_capture_time_ns_);
  }
  return absl::OkStatus();
}

absl::Status FrameDecoder::CheckSizes(const v1::FrameBatch& batch) const {
  if (!batch.has_sparse()) {
    const size_t want = batch.frame_count() * value_count_ * taxel_bytes_;
    if (batch.taxels().size() == want) return absl::OkStatus();
    return FrameSizeMismatch(batch.first_sequence(), "taxels",
                             batch.taxels().size(), want);
  }
  if (!batch.taxels().empty()) {
    return FrameSizeMismatch(batch.first_sequence(), "taxels beside sparse",
                             batch.taxels().size(), 0);
  }
  return CheckSparse(batch);
}

absl::Status FrameDecoder::CheckSparse(const v1::FrameBatch& batch) const {
  const v1::SparseFrames& sparse = batch.sparse();
  const uint64_t first = batch.first_sequence();
  if (sparse.counts_size() != static_cast<int>(batch.frame_count())) {
    return FrameSizeMismatch(first, "sparse.counts", sparse.counts_size(),
                             batch.frame_count());
  }
  uint64_t entries = 0;
  for (const uint32_t count : sparse.counts()) entries += count;
  if (sparse.indices().size() != entries * 2) {
    return FrameSizeMismatch(first, "sparse.indices", sparse.indices().size(),
                             entries * 2);
  }
  if (sparse.values().size() != entries * taxel_bytes_) {
    return FrameSizeMismatch(first, "sparse.values", sparse.values().size(),
                             entries * taxel_bytes_);
  }
  size_t entry = 0;
  for (uint32_t i = 0; i < batch.frame_count(); ++i) {
    int last = -1;
    for (uint32_t k = 0; k < sparse.counts(i); ++k, ++entry) {
      const uint16_t taxel = SparseIndex(sparse, entry);
      if (taxel >= value_count_) {
        return InvalidSparseIndex(first + i, taxel,
                                  absl::StrCat("below ", value_count_));
      }
      if (taxel <= last) {
        return InvalidSparseIndex(first + i, taxel,
                                  absl::StrCat("above the one before, ", last));
      }
      last = taxel;
    }
  }
  return absl::OkStatus();
}

absl::Status FrameDecoder::CheckPoses(const v1::FrameBatch& batch) const {
  const uint64_t first = batch.first_sequence();
  const int want =
      with_poses_ ? static_cast<int>(batch.frame_count()) * kPoseSize : 0;
  if (batch.poses_size() != want) {
    return InvalidPose(first, absl::StrCat("poses has ", batch.poses_size(),
                                           " numbers; it must have ", want));
  }
  for (int i = 0; i < want; i += kPoseSize) {
    const double* pose = batch.poses().data() + i;
    const uint64_t sequence = first + i / kPoseSize;
    for (int k = 0; k < kPoseSize; ++k) {
      if (!std::isfinite(pose[k])) {
        return InvalidPose(sequence, "a number is not finite");
      }
    }
    for (int k = 0; k < 3; ++k) {
      if (std::abs(pose[k]) > limits::kMaxPositionM) {
        return InvalidPose(
            sequence,
            absl::StrCat("position ", pose[k], " m; it must be within ",
                         limits::kMaxPositionM, " m of 0"));
      }
    }
    const double norm = std::sqrt(pose[3] * pose[3] + pose[4] * pose[4] +
                                  pose[5] * pose[5] + pose[6] * pose[6]);
    // Written so that an overflowed norm fails, too.
    if (!(std::abs(norm - 1) <= limits::kQuaternionTolerance)) {
      return InvalidPose(sequence, absl::StrCat("quaternion of length ", norm,
                                                "; it must be 1"));
    }
  }
  return absl::OkStatus();
}

absl::Status FrameDecoder::CheckValues(const v1::FrameBatch& batch) {
  if (batch.has_sparse()) return CheckListedValues(batch);
  if (ValuesAreWithin(batch.taxels())) return absl::OkStatus();
  // Masked taxels may hold anything.
  for (uint32_t i = 0; i < batch.frame_count(); ++i) {
    DecodeDense(batch, i);
    const auto bad = std::ranges::find_if_not(
        taxels_, [this](float value) { return range_.Has(value); });
    if (bad == taxels_.end()) continue;
    return BadValue(batch.first_sequence() + i,
                    static_cast<size_t>(bad - taxels_.begin()), *bad);
  }
  return absl::OkStatus();
}

bool FrameDecoder::ValuesAreWithin(absl::string_view wire) const {
  // No count is negative, and few scales make the largest one too large.
  if (taxel_type_ == v1::TAXEL_TYPE_UINT16 &&
      range_.Has(tactus::internal::ScaledTaxel(
          std::numeric_limits<uint16_t>::max(), scale_))) {
    return true;
  }
  return TaxelsWithin(taxel_type_, wire.data(), wire.size() / taxel_bytes_,
                      scale_, range_);
}

absl::Status FrameDecoder::BadValue(uint64_t sequence, size_t place,
                                    float value) const {
  const int taxel = static_cast<int>(place) / axes_;
  if (!std::isfinite(value)) return NonFiniteTaxel(sequence, taxel);
  if (value < range_.lowest && range_.lowest == 0) {
    return NegativeTaxel(sequence, taxel, value);
  }
  return TaxelTooLarge(sequence, taxel, value);
}

absl::Status FrameDecoder::CheckListedValues(
    const v1::FrameBatch& batch) const {
  const v1::SparseFrames& sparse = batch.sparse();
  size_t entry = 0;
  for (uint32_t i = 0; i < batch.frame_count(); ++i) {
    for (uint32_t k = 0; k < sparse.counts(static_cast<int>(i)); ++k, ++entry) {
      const uint16_t place = SparseIndex(sparse, entry);
      const float value = SparseValue(sparse, entry);
      if (range_.Has(value) || Masked(place)) continue;
      return BadValue(batch.first_sequence() + i, place, value);
    }
  }
  return absl::OkStatus();
}

FrameView FrameDecoder::Frame(const v1::FrameBatch& batch, uint32_t index) {
  if (batch.has_sparse()) {
    DecodeSparse(batch, index);
  } else {
    DecodeDense(batch, index);
  }
  FrameView frame;
  frame.taxels = taxels_;
  if (with_poses_) {
    const double* p = batch.poses().data() + index * kPoseSize;
    pose_.position = {p[0], p[1], p[2]};
    // Eigen's constructor takes w first.
    pose_.orientation = Eigen::Quaterniond(p[6], p[3], p[4], p[5]);
    frame.pose = &pose_;
  }
  return frame;
}

void FrameDecoder::Accept(const v1::FrameBatch& batch) {
  last_sequence_ = batch.first_sequence() + batch.frame_count() - 1;
  last_capture_time_ns_ = CaptureTime(batch, batch.frame_count() - 1);
  if (listed_only_) sparse_frames_ += batch.frame_count();
}

int64_t FrameDecoder::CaptureTime(const v1::FrameBatch& batch,
                                  uint32_t index) const {
  return batch.first_capture_time_ns() + std::llround(index * frame_period_ns_);
}

void FrameDecoder::DecodeDense(const v1::FrameBatch& batch, uint32_t index) {
  const char* wire =
      batch.taxels().data() + index * value_count_ * taxel_bytes_;
  ScaleTaxels(taxel_type_, wire, scale_, taxels_);
  listed_only_ = false;
  // What a masked taxel holds is never looked at.
  for (size_t i = 0; i < mask_.size(); ++i) {
    if (mask_[i] == 0) taxels_[i] = 0;
  }
}

void FrameDecoder::DecodeSparse(const v1::FrameBatch& batch, uint32_t index) {
  const v1::SparseFrames& sparse = batch.sparse();
  if (index == 0) sparse_entry_ = 0;
  if (listed_only_) {
    for (const uint16_t taxel : listed_) taxels_[taxel] = 0;
  } else {
    std::ranges::fill(taxels_, 0.0F);
  }
  listed_only_ = skip_unlisted_;
  listed_.clear();
  for (uint32_t k = 0; k < sparse.counts(static_cast<int>(index)); ++k) {
    const uint16_t taxel = SparseIndex(sparse, sparse_entry_);
    if (!Masked(taxel)) {
      taxels_[taxel] = SparseValue(sparse, sparse_entry_);
      listed_.push_back(taxel);
    }
    ++sparse_entry_;
  }
}

float FrameDecoder::SparseValue(const v1::SparseFrames& sparse,
                                size_t entry) const {
  // In double, as trial files are read: the same bits online and offline.
  return ScaledTaxel(taxel_type_, sparse.values().data() + entry * taxel_bytes_,
                     scale_);
}

}  // namespace tactus::internal
