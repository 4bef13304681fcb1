#include "server/monitor/watched_stream.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "absl/strings/numbers.h"

namespace tactus::internal::server {
namespace {

constexpr double kNsPerS = 1e9;
constexpr int64_t kRateWindowNs = 2'000'000'000;

static_assert(std::endian::native == std::endian::little,
              "taxels are sent as they lie in memory");

uint64_t NumberOf(const std::string& id) {
  uint64_t number = 0;
  return absl::SimpleAtoi(id, &number) ? number : 0;
}

}  // namespace

WatchedStream::WatchedStream(v1::OpenStream description, bool expected)
    : description_(std::move(description)),
      number_(NumberOf(description_.stream_id())),
      watchers_(expected ? 1 : 0),
      expected_(expected) {}

void WatchedStream::End() {
  {
    const std::lock_guard lock(mutex_);
    ShowEvents();
  }
  ended_ = true;
}

void WatchedStream::Found() {
  if (expected_.exchange(false)) RemoveWatcher();
}

void WatchedStream::ShowEvents() {
  if (waiting_.empty()) return;
  events_.resize(limits::kMaxWatchedEvents);
  for (v1::WatchedEvent& event : waiting_) {
    events_[event_count_++ % events_.size()] = std::move(event);
  }
  waiting_.clear();
}

void WatchedStream::EndMessage(const Counts& counts, int64_t now_ns) {
  constexpr auto kRelaxed = std::memory_order_relaxed;
  frames_.store(counts.frames, kRelaxed);
  frames_missing_.store(counts.frames_missing, kRelaxed);
  superseded_.store(counts.superseded, kRelaxed);
  contacts_.store(counts.contacts, kRelaxed);
  contacts_now_.store(counts.contacts_now, kRelaxed);
  last_message_ns_.store(now_ns, kRelaxed);
  if (window_ns_ == 0) {
    window_ns_ = now_ns;
    window_frames_ = counts.frames;
  }
  if (now_ns - window_ns_ < kRateWindowNs) return;
  const auto window = static_cast<double>(now_ns - window_ns_);
  const auto frames = static_cast<double>(counts.frames - window_frames_);
  measured_rate_hz_.store(frames * kNsPerS / window, kRelaxed);
  window_ns_ = now_ns;
  window_frames_ = counts.frames;
}

v1::Answer* WatchedStream::Want(bool has_events) {
  if (watchers_.load(std::memory_order_relaxed) == 0) return nullptr;
  const bool wanted = has_events || asked_.load(std::memory_order_relaxed);
  return wanted ? &answer_ : nullptr;
}

void WatchedStream::Take(const FrameView& frame, const v1::Answer& answer) {
  for (const v1::ContactEvent& event : answer.events()) {
    v1::WatchedEvent& waiting = waiting_.emplace_back();
    waiting.set_sequence(answer.sequence());
    waiting.set_capture_time_ns(answer.capture_time_ns());
    const auto contact = std::ranges::find(
        answer.contacts(), event.contact_id(), &v1::Contact::id);
    if (contact != answer.contacts().end()) {
      waiting.set_time_since_onset_ns(contact->time_since_onset_ns());
    }
    *waiting.mutable_event() = event;
  }
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  asked_.store(false, std::memory_order_relaxed);
  ShowEvents();
  taxels_.assign(frame.taxels.begin(), frame.taxels.end());
  taken_ns_ = message_ns_;
  ++shown_count_;
  shown_.Swap(&answer_);
}

v1::OpenStream WatchedStream::Describe(int64_t now_ns) const {
  v1::OpenStream stream = description_;
  WriteCounts(now_ns, stream.mutable_counts());
  return stream;
}

void WatchedStream::WriteCounts(int64_t now_ns,
                                v1::StreamCounts* counts) const {
  constexpr int64_t kNsPerMs = 1'000'000;
  counts->set_frames(frames_);
  counts->set_frames_missing(frames_missing_);
  counts->set_superseded(superseded_);
  counts->set_contacts(contacts_);
  counts->set_contacts_now(static_cast<uint32_t>(contacts_now_.load()));
  counts->set_measured_rate_hz(measured_rate_hz_);
  counts->set_silent_ms(std::max<int64_t>(0, now_ns - last_message_ns_) /
                        kNsPerMs);
}

WatchedStream::Cursor WatchedStream::Now() {
  const std::lock_guard lock(mutex_);
  return {.frames = shown_count_, .events = event_count_};
}

bool WatchedStream::ReadNew(int64_t now_ns, bool with_taxels, Cursor* cursor,
                            v1::StreamUpdate* update) {
  const std::lock_guard lock(mutex_);
  if (cursor->frames == shown_count_ && cursor->events == event_count_) {
    return false;
  }
  const uint64_t first =
      std::max(cursor->events,
               event_count_ - std::min<uint64_t>(event_count_, events_.size()));
  update->set_events_left_out(first - cursor->events);
  for (uint64_t e = first; e < event_count_; ++e) {
    *update->add_events() = events_[e % events_.size()];
  }
  if (cursor->frames < shown_count_) {
    v1::WatchedFrame* frame = update->mutable_frame();
    *frame->mutable_answer() = shown_;
    frame->mutable_answer()->clear_events();
    frame->set_age_us((now_ns - taken_ns_) / 1000);
    if (with_taxels) {
      frame->set_taxels(taxels_.data(), taxels_.size() * sizeof(float));
    }
  }
  *cursor = {.frames = shown_count_, .events = event_count_};
  return true;
}

}  // namespace tactus::internal::server
