#include "server/contact_log/contact_recorder.h"

#include <algorithm>
#include <numeric>
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
      settled_frames_(
          static_cast<uint64_t>(kSettledS * RateOf(stream->config())) + 1) {
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
    current_.exact =
        from_trial_start_ ||
        (!light_touch_ && std::accumulate(before_.begin(), before_.end(),
                                          uint64_t{0}) >= settled_frames_);
  }
  open_ = answer.is_final()
              ? 0
              : static_cast<int>(std::ranges::count_if(
                    answer.contacts(), [](const v1::Contact& contact) {
                      return contact.state() != v1::Contact::STATE_RELEASED;
                    }));
  if (lost_) return;
  lost_ = !Append(v1::Recording::kAnswersFieldNumber, answer,
                  limits::kMaxRecordingChunks);
}

void ContactRecorder::EndMessage(const v1::FrameBatch* frames, int64_t now_ms) {
  if (waiting_.count > 0 && sink_->TryTake(waiting_)) waiting_.count = 0;
  if (frames != nullptr && !recording_) {
    KeepBefore(*frames);
  } else if (frames != nullptr && !current_.cut && !lost_) {
    current_.cut = !Append(v1::Recording::kFramesFieldNumber, *frames,
                           limits::kMaxFrameChunks);
  }
  if (recording_ && open_ == 0) {
    Finish(now_ms);
  } else if (trial_ended_) {
    Begin(/*at_trial_start=*/true);
  }
}

void ContactRecorder::KeepBefore(const v1::FrameBatch& frames) {
  const auto keep = [&] {
    if (!Append(v1::Recording::kFramesFieldNumber, frames,
                limits::kBeforeContactChunks)) {
      return false;
    }
    before_[current_.count - 1] += frames.frame_count();
    return true;
  };
  if (keep()) return;
  if (current_.count == limits::kBeforeContactChunks) {
    pool_->Give(current_.chunks[0]);
    std::shift_left(current_.chunks.begin(), current_.chunks.end(), 1);
    std::shift_left(current_.sizes.begin(), current_.sizes.end(), 1);
    std::shift_left(before_.begin(), before_.end(), 1);
    before_.back() = 0;
    --current_.count;
    from_trial_start_ = false;
    if (keep()) return;
  }
  // There must be no gap between these frames and the contact.
  Begin(/*at_trial_start=*/false);
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
  before_ = {};
  recording_ = false;
  open_ = 0;
  lost_ = false;
  trial_ended_ = false;
}

void ContactRecorder::EndStream(int64_t now_ms) {
  if (recording_) Finish(now_ms);
  if (waiting_.count > 0) sink_->Take(waiting_);
  waiting_.count = 0;
}

}  // namespace tactus::internal::server
