#include "server/monitor/stream_watch.h"

#include <algorithm>
#include <utility>

namespace tactus::internal::server {
namespace {

constexpr int64_t kNsPerSecond = 1'000'000'000;

}  // namespace

StreamWatch::StreamWatch(std::shared_ptr<WatchedStream> stream,
                         const Options& options)
    : stream_(std::move(stream)),
      options_(options),
      period_ns_(kNsPerSecond /
                 std::max<int64_t>(1, options.frames_per_second)),
      cursor_(options.from_start ? WatchedStream::Cursor() : stream_->Now()) {
  if (options_.frames_per_second > 0) stream_->AddWatcher();
}

StreamWatch::~StreamWatch() {
  if (options_.frames_per_second > 0) stream_->RemoveWatcher();
}

bool StreamWatch::ReadFrame(int64_t now_ns, bool ends,
                            v1::StreamUpdate* update) {
  constexpr int64_t kAhead = 2 * std::chrono::nanoseconds(kLook).count();
  if ((now_ns >= next_frame_ns_ || ends) &&
      stream_->ReadNew(now_ns, options_.with_taxels, &cursor_, update)) {
    // In step, unless there was nothing for longer than a period.
    const bool late = now_ns - next_frame_ns_ >= period_ns_;
    next_frame_ns_ = (late ? now_ns : next_frame_ns_) + period_ns_;
    return true;
  }
  if (next_frame_ns_ - now_ns < kAhead) stream_->Ask();
  return false;
}

bool StreamWatch::Update(int64_t now_ns, v1::StreamUpdate* update) {
  // Before the last frame is read: none comes after it.
  const bool ends = !ended_ && stream_->ended();
  bool any = ends || !described_;
  if (options_.frames_per_second > 0)
    any = ReadFrame(now_ns, ends, update) || any;
  if (now_ns - counted_ns_ >= kNsPerSecond) any = true;
  if (!any) return false;
  update->set_stream_id(stream_->id());
  if (!described_) *update->mutable_opened() = stream_->Describe(now_ns);
  described_ = true;
  stream_->WriteCounts(now_ns, update->mutable_counts());
  counted_ns_ = now_ns;
  if (ends) update->set_ended(true);
  ended_ = ended_ || ends;
  return true;
}

}  // namespace tactus::internal::server
