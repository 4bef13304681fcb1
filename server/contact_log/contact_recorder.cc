#include "server/contact_log/contact_recorder.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/message_lite.h"

namespace tactus::internal::server {
namespace {

using google::protobuf::io::CodedOutputStream;

constexpr double kSettledS = 0.5;
constexpr int kLengthDelimited = 2;

double RateOf(const v1::StreamConfig& config) {
  return config.has_sample_rate_hz() ? config.sample_rate_hz() : 100;
}

}  // namespace

ContactRecorder::ContactRecorder(
    ChunkPool* pool, RecordingSink* sink,
    std::shared_ptr<const v1::RecordedStream> stream)
    : pool_(pool),
      sink_(sink),
      light_touch_(stream->started().geometry().has_light_touch()),
      with_poses_(stream->config().with_poses()),
      settled_frames_(
          static_cast<uint64_t>(kSettledS * RateOf(stream->config())) + 1),
      spacing_(RateOf(stream->config())) {
  current_.stream = std::move(stream);
}

ContactRecorder::~ContactRecorder() {
  current_.GiveBack(*pool_);
  waiting_.GiveBack(*pool_);
}

void ContactRecorder::Take(const FrameView& /*frame*/,
                           const v1::Answer& answer) {
  if (answer.is_final()) trial_ended_ = true;
  if (!recording_) {
    // The final of a trial shows the contact that ended last.
    if (answer.is_final() || answer.contacts().empty()) return;
    recording_ = true;
    current_.exact = IsSettled();
  }
  open_ = answer.is_final()
              ? 0
              : static_cast<int>(std::ranges::count_if(
                    answer.contacts(), [](const v1::Contact& contact) {
                      return contact.state() != v1::Contact::STATE_RELEASED;
                    }));
  if (lost_ || Append(v1::Recording::kAnswersFieldNumber, answer,
                      limits::kMaxRecordingChunks)) {
    return;
  }
  Lose();
}

bool ContactRecorder::IsSettled() const {
  if (from_trial_start_) return true;
  if (light_touch_) return false;
  if (!before_[0].has_start || before_[0].start_bytes > 0) return false;
  uint64_t frames = 0;
  for (const Before& before : before_) frames += before.frames;
  return frames >= settled_frames_;
}

bool ContactRecorder::StepPoses(const v1::FrameBatch& frames) {
  if (!with_poses_) return true;
  bool is_start = false;
  for (uint32_t i = 0; i < frames.frame_count(); ++i) {
    const bool counts_gap = i == 0 && next_sequence_ > 0;
    spacing_.Step(counts_gap ? frames.first_sequence() - next_sequence_ : 0);
    const bool kept = spacing_.Keep();
    if (i == 0) is_start = kept;
  }
  next_sequence_ = frames.first_sequence() + frames.frame_count();
  return is_start;
}

void ContactRecorder::EndMessage(const v1::FrameBatch* frames, int64_t now_ms) {
  if (waiting_.count > 0 && sink_->TryTake(waiting_)) waiting_.count = 0;
  const bool is_start = frames != nullptr && StepPoses(*frames);
  if (frames != nullptr && !recording_) {
    KeepBefore(*frames, is_start);
  } else if (frames != nullptr && !current_.cut && !lost_ &&
             !Append(v1::Recording::kFramesFieldNumber, *frames,
                     limits::kMaxFrameChunks)) {
    current_.cut = current_.count >= limits::kMaxFrameChunks;
    if (!current_.cut) Lose();
  }
  if (recording_ && open_ == 0) {
    Finish(now_ms);
  } else if (trial_ended_) {
    Begin(/*at_trial_start=*/true);
  }
}

void ContactRecorder::KeepBefore(const v1::FrameBatch& frames, bool is_start) {
  if (current_.count == 0 && !is_start) return;
  const auto keep = [&] {
    const int chunks = current_.count;
    const uint32_t used = chunks == 0 ? 0 : current_.sizes[chunks - 1];
    if (!Append(v1::Recording::kFramesFieldNumber, frames,
                limits::kBeforeContactChunks)) {
      return false;
    }
    Before& before = before_[current_.count - 1];
    if (is_start && !before.has_start) {
      before.has_start = true;
      before.start_bytes = current_.count == chunks ? used : 0;
      before.start_frames = before.frames;
    }
    before.frames += frames.frame_count();
    return true;
  };
  if (keep()) return;
  if (current_.count == limits::kBeforeContactChunks) {
    DropOldestBefore();
    if (keep()) return;
  }
  // There must be no gap between these frames and the contact.
  Begin(/*at_trial_start=*/false);
}

void ContactRecorder::DropOldestBefore() {
  pool_->Give(current_.chunks[0]);
  std::shift_left(current_.chunks.begin(), current_.chunks.end(), 1);
  std::shift_left(current_.sizes.begin(), current_.sizes.end(), 1);
  std::shift_left(before_.begin(), before_.end(), 1);
  before_.back() = {};
  --current_.count;
  from_trial_start_ = false;
  Before& first = before_[0];
  if (!first.has_start || first.start_bytes == 0) return;
  uint8_t* const bytes = pool_->bytes(current_.chunks[0]).data();
  current_.sizes[0] -= first.start_bytes;
  std::memmove(bytes, bytes + first.start_bytes, current_.sizes[0]);
  first.frames -= first.start_frames;
  first.start_bytes = 0;
  first.start_frames = 0;
}

bool ContactRecorder::Append(int field,
                             const google::protobuf::MessageLite& message,
                             int most_chunks) {
  const size_t size = message.ByteSizeLong();
  const auto tag = static_cast<uint32_t>(field << 3 | kLengthDelimited);
  const size_t all =
      CodedOutputStream::VarintSize32(tag) +
      CodedOutputStream::VarintSize32(static_cast<uint32_t>(size)) + size;
  if (all > limits::kRecordingChunkBytes) return false;
  const int last = current_.count - 1;
  if (last < 0 || current_.sizes[last] + all > limits::kRecordingChunkBytes) {
    if (current_.count >= most_chunks) return false;
    const int chunk = pool_->Take();
    if (chunk == ChunkPool::kNone) return false;
    current_.chunks[current_.count] = chunk;
    current_.sizes[current_.count] = 0;
    ++current_.count;
  }
  const int newest = current_.count - 1;
  uint8_t* at =
      pool_->bytes(current_.chunks[newest]).data() + current_.sizes[newest];
  at = CodedOutputStream::WriteVarint32ToArray(tag, at);
  at = CodedOutputStream::WriteVarint32ToArray(static_cast<uint32_t>(size), at);
  message.SerializeWithCachedSizesToArray(at);
  current_.sizes[newest] += static_cast<uint32_t>(all);
  return true;
}

void ContactRecorder::Lose() {
  lost_ = true;
  current_.GiveBack(*pool_);
}

void ContactRecorder::Finish(int64_t now_ms) {
  if (lost_) {
    sink_->OnLeftOut();
  } else {
    current_.end_time_ms = now_ms;
    if (current_.cut) current_.exact = false;
    // The one that waits still has had its time.
    if (waiting_.count > 0) sink_->OnLeftOut();
    waiting_.GiveBack(*pool_);
    waiting_ = current_;
    current_.count = 0;
    if (sink_->TryTake(waiting_)) waiting_.count = 0;
  }
  Begin(trial_ended_);
}

void ContactRecorder::Begin(bool at_trial_start) {
  current_.GiveBack(*pool_);
  current_.cut = false;
  current_.exact = false;
  from_trial_start_ = at_trial_start;
  if (at_trial_start) {
    spacing_.Reset();
    next_sequence_ = 0;
  }
  before_ = {};
  recording_ = false;
  open_ = 0;
  lost_ = false;
  trial_ended_ = false;
}

void ContactRecorder::EndStream(int64_t now_ms) {
  const auto hand_over = [this] {
    if (waiting_.count > 0) sink_->Take(waiting_);
    waiting_.count = 0;
  };
  hand_over();
  if (recording_) Finish(now_ms);
  hand_over();
}

}  // namespace tactus::internal::server
