#include "server/rpc/stream_families.h"

#include <string>
#include <utility>

namespace tactus::internal::server {
namespace {

using Counter = std::atomic<uint64_t> LaneMetrics::*;
using Times = Histogram LaneMetrics::*;

// The name of a rule as a label; null if it is not counted in streams.
const char* NameOf(SkipRule rule) {
  switch (rule) {
    case SkipRule::kUntouchedFrames:
      return "untouched_frames";
    case SkipRule::kUnchangedFrames:
      return "unchanged_frames";
    case SkipRule::kUnchangedScores:
      return "unchanged_scores";
    case SkipRule::kUnusedLstms:
      return "unused_lstms";
    case SkipRule::kUnlistedTaxels:
      return "unlisted_taxels";
    case SkipRule::kQuietRows:
      return "quiet_rows";
    case SkipRule::kUnusedCues:
      break;
  }
  return nullptr;
}

void AddOne(Family family, const Labels& labels, double value,
            Families* families) {
  Add(labels, value, &family);
  families->push_back(std::move(family));
}

}  // namespace

void CollectStreams(std::span<const LaneMetrics* const> lanes,
                    const StreamGate& gate, const SkipTotals& skipped,
                    Families* families) {
  const auto add_sum = [&](Family family, const Labels& labels,
                           Counter counter) {
    uint64_t sum = 0;
    for (const LaneMetrics* lane : lanes) sum += lane->*counter;
    AddOne(std::move(family), labels, static_cast<double>(sum), families);
  };
  const auto add_times = [&](Family family, Times times) {
    Histogram::Data data;
    for (const LaneMetrics* lane : lanes) data.Add((lane->*times).Read());
    Add({}, data, kFrameSeconds, &family);
    families->push_back(std::move(family));
  };
  const Labels stream = {{"grpc_type", "bidi_stream"},
                         {"grpc_service", "tactus.v1.ContactService"},
                         {"grpc_method", "ClassifyContact"}};
  add_sum(CounterFamily("grpc_server_msg_received_total",
                        "Messages that came on streams."),
          stream, &LaneMetrics::messages_received);
  add_sum(CounterFamily("grpc_server_msg_sent_total",
                        "Messages that were sent on streams."),
          stream, &LaneMetrics::messages_sent);
  add_sum(CounterFamily("tactus_frames_total", "Frames of streams."), {},
          &LaneMetrics::frames);
  add_sum(CounterFamily("tactus_frames_missing_total",
                        "Frames that were lost before they came, by their "
                        "sequence numbers."),
          {}, &LaneMetrics::frames_missing);
  add_sum(CounterFamily("tactus_posteriors_superseded_total",
                        "Interim answers that were dropped because the robot "
                        "read slowly."),
          {}, &LaneMetrics::superseded);
  add_times(HistogramFamily("tactus_frame_processing_seconds",
                            "Time that a frame took to be classified."),
            &LaneMetrics::processing);
  add_times(HistogramFamily("tactus_frame_queue_seconds",
                            "Time that an answer waited to be written."),
            &LaneMetrics::waiting);
  AddOne(GaugeFamily("tactus_streams", "Open streams and trials."), {},
         gate.live(), families);
  AddOne(CounterFamily("tactus_streams_opened_total",
                       "Streams and trials that were admitted."),
         {}, static_cast<double>(gate.opened()), families);
  Family work = CounterFamily(
      "tactus_skipped_total",
      "Work that streams which have ended did not need, by rule.");
  for (int i = 0; i < kSkipRuleCount; ++i) {
    const auto rule = static_cast<SkipRule>(i);
    if (NameOf(rule) == nullptr) continue;
    Add({{"rule", NameOf(rule)}}, static_cast<double>(skipped.total(rule)),
        &work);
  }
  families->push_back(std::move(work));
}

}  // namespace tactus::internal::server
