// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/stream/contact_session.h"
#include "server/metrics/answer_metrics.h"
#include "server/metrics/families.h"
#include "server/metrics/histogram.h"
#include "server/metrics/lane_metrics.h"
#include "server/metrics/metrics_listener.h"
#include "server/metrics/open_metrics.h"
#include "server/metrics/reason_counts.h"
#include "server/metrics/rpc_metrics.h"
#include "server/metrics/server_metrics.h"
#include "server/monitor/open_streams.h"
#include "server/monitor/stream_watch.h"
#include "server/monitor/watched_stream.h"
#include "server/rpc/contact_log_rpcs.h"
#include "server/rpc/monitor_rpcs.h"
#include "server/rpc/stream_families.h"
#include "server/session/tap_pair.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server::examples {

void Show(const v1::OpenStream& stream);
void Send(const v1::StreamUpdate& update);

static void AnswerMetricsExample(AnswerMetrics& metrics,
                                 const v1::StreamStarted& started,
                                 const v1::Answer& answer, Families& families) {
#include "server/metrics/answer_metrics.h.inc"
}

static void FamiliesExample() {
#include "server/metrics/families.h.inc"
}

static void HistogramExample() {
#include "server/metrics/histogram.h.inc"
}

static void LaneMetricsExample(LaneMetrics& lane, const v1::FrameBatch& batch) {
#include "server/metrics/lane_metrics.h.inc"
}

static absl::Status MetricsListenerExample(
    const MetricsListener::Collect& collect) {
#include "server/metrics/metrics_listener.h.inc"
  return absl::OkStatus();
}

static void OpenMetricsExample(const Families& families) {
#include "server/metrics/open_metrics.h.inc"
}

static void ReasonCountsExample(ReasonCounts& refused,
                                const absl::Status& status,
                                Families& families) {
#include "server/metrics/reason_counts.h.inc"
}

static void RpcMetricsExample(RpcMetrics& metrics, absl::StatusCode status,
                              double seconds, Families& families) {
#include "server/metrics/rpc_metrics.h.inc"
}

static void ServerMetricsExample(const std::string& method,
                                 const absl::Status& status) {
#include "server/metrics/server_metrics.h.inc"
}

static void OpenStreamsExample(OpenStreams& streams, v1::OpenStream description,
                               int64_t now_ns) {
#include "server/monitor/open_streams.h.inc"
}

static void StreamWatchExample(const std::shared_ptr<WatchedStream>& stream,
                               int64_t now_ns) {
#include "server/monitor/stream_watch.h.inc"
}

static void TapPairExample(WatchedStream& watched, ContactRecorder& recorder,
                           ContactSession& session) {
#include "server/session/tap_pair.h.inc"
}

static void WatchedStreamExample(const v1::OpenStream& description,
                                 ContactSession& session, int64_t now_ns) {
  v1::StreamUpdate update;
#include "server/monitor/watched_stream.h.inc"
}

static void ContactLogRpcsExample(ContactLog* log, const ModelSource& models,
                                  TrainingBackend* backend,
                                  ControlService& control) {
#include "server/rpc/contact_log_rpcs.h.inc"
}

static void MonitorRpcsExample(OpenStreams& open_streams,
                               ControlService& control) {
#include "server/rpc/monitor_rpcs.h.inc"
}

static void StreamFamiliesExample(std::vector<const LaneMetrics*> lanes,
                                  const StreamGate& gate,
                                  const SkipTotals& skipped,
                                  Families& families) {
#include "server/rpc/stream_families.h.inc"
}

}  // namespace tactus::internal::server::examples
