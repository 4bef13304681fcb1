#include "server/rpc/monitor_rpcs.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/numbers.h"
#include "core/base/errors.h"
#include "core/base/limits_monitor.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "server/monitor/stream_watch.h"
#include "server/ops/clock.h"
#include "server/records/paging.h"
#include "server/rpc/control_handlers.h"
#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kMonitorService[] = "/tactus.v1.MonitorService/";
// Streams of a page, so that a page is less than a megabyte.
constexpr int kPage = 100;
// A message with more updates than fit in this is sent as several.
constexpr size_t kMessageBytes = 1024UL * 1024;

// A handler of one of the calls that watch, of which there may be only some.
template <typename Request>
ControlService::Handler Watching(
    const std::shared_ptr<std::atomic<int>>& watchers,
    std::function<absl::Status(const Request&, ControlStream&)> watch) {
  return ServerStream<Request>(
      [watchers, watch = std::move(watch)](const Request& request,
                                           ControlStream& call) {
        const absl::Cleanup leave = [&watchers] { --*watchers; };
        if (++*watchers > limits::kMaxWatchers) {
          return StreamLimit("watchers", limits::kMaxWatchers);
        }
        return watch(request, call);
      });
}

template <typename Request>
absl::StatusOr<StreamWatch::Options> ParseOptions(const Request& request) {
  const uint32_t rate = request.frames_per_second();
  if (rate > limits::kMaxWatchedRateHz) {
    return InvalidConfig("frames_per_second", rate,
                         absl::StrCat("1 to ", limits::kMaxWatchedRateHz,
                                      ", or 0 for the most"));
  }
  return StreamWatch::Options{
      .frames_per_second = rate == 0 ? limits::kMaxWatchedRateHz : rate,
      .with_taxels = !request.without_taxels()};
}

absl::StatusOr<v1::ListStreamsResponse> ListStreams(
    const OpenStreams& streams, const v1::ListStreamsRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(const int size, PageSize(request.page_size()));
  uint64_t last = 0;
  if (!request.page_token().empty() &&
      !absl::SimpleAtoi(request.page_token(), &last)) {
    return InvalidConfig("page_token", Quoted(request.page_token()),
                         "next_page_token of the page before");
  }
  v1::ListStreamsResponse response;
  const int64_t now_ns = MonotonicNs();
  for (const auto& stream : streams.List()) {
    if (stream->number() <= last) continue;
    if (response.streams_size() == std::min(size, kPage)) {
      response.set_next_page_token(
          response.streams(response.streams_size() - 1).stream_id());
      break;
    }
    *response.add_streams() = stream->Describe(now_ns);
  }
  return response;
}

absl::Status WatchStream(const OpenStreams& streams,
                         const v1::WatchStreamRequest& request,
                         ControlStream& call) {
  TACTUS_ASSIGN_OR_RETURN(const auto options, ParseOptions(request));
  auto stream = streams.Find(request.stream_id());
  if (stream == nullptr) {
    return NoSuch(v1::ERROR_REASON_STREAM_NOT_FOUND, "stream",
                  request.stream_id(),
                  "trainctl streams list shows those open");
  }
  StreamWatch watch(std::move(stream), options);
  v1::WatchStreamResponse response;
  while (!watch.ended()) {
    if (call.IsCancelled()) return WorkCancelled("the watch");
    response.Clear();
    if (watch.Update(MonotonicNs(), response.mutable_update())) {
      TACTUS_RETURN_IF_ERROR(WriteMessage(call, response));
    }
    std::this_thread::sleep_for(StreamWatch::kLook);
  }
  return absl::OkStatus();
}

// Watches of all streams that are open, and of those that have just ended.
class AllStreams {
 public:
  AllStreams(OpenStreams& streams, const StreamWatch::Options& options)
      : streams_(streams), options_(options) {
    if (options_.frames_per_second > 0) streams_.AddFollower();
  }
  ~AllStreams() {
    if (options_.frames_per_second > 0) streams_.RemoveFollower();
  }

  AllStreams(const AllStreams&) = delete;
  AllStreams& operator=(const AllStreams&) = delete;

  // Begins to watch the streams that have opened, and forgets those whose end
  // was told.
  void Follow() {
    watches_.remove_if([this](const StreamWatch& watch) {
      if (watch.ended()) known_.erase(watch.stream());
      return watch.ended();
    });
    for (auto& stream : streams_.List()) {
      if (!known_.insert(stream.get()).second) continue;
      StreamWatch::Options options = options_;
      if (watches_.size() >= limits::kMaxWatchedStreams) {
        options.frames_per_second = 0;
      }
      // Those of the first look were there before.
      options.from_start = looked_;
      WatchedStream* const opened = stream.get();
      watches_.emplace_back(std::move(stream), options);
      opened->Found();
    }
    looked_ = true;
  }

  std::list<StreamWatch>& watches() { return watches_; }

 private:
  OpenStreams& streams_;
  const StreamWatch::Options options_;
  bool looked_ = false;
  std::list<StreamWatch> watches_;
  std::set<const WatchedStream*> known_;
};

absl::Status WatchAll(OpenStreams& streams, const v1::WatchAllRequest& request,
                      ControlStream& call) {
  TACTUS_ASSIGN_OR_RETURN(const auto options, ParseOptions(request));
  AllStreams all(streams, options);
  v1::WatchAllResponse response;
  v1::StreamUpdate update;
  bool answered = false;
  while (!call.IsCancelled()) {
    all.Follow();
    response.Clear();
    size_t bytes = 0;
    const int64_t now_ns = MonotonicNs();
    for (StreamWatch& watch : all.watches()) {
      update.Clear();
      if (!watch.Update(now_ns, &update)) continue;
      bytes += update.ByteSizeLong();
      response.add_updates()->Swap(&update);
      if (bytes < kMessageBytes) continue;
      TACTUS_RETURN_IF_ERROR(WriteMessage(call, response));
      response.Clear();
      bytes = 0;
    }
    if (response.updates_size() > 0 || !answered) {
      TACTUS_RETURN_IF_ERROR(WriteMessage(call, response));
      answered = true;
    }
    std::this_thread::sleep_for(StreamWatch::kLook);
  }
  return WorkCancelled("the watch");
}

}  // namespace

void AddMonitorRpcs(OpenStreams* streams, ControlService& control) {
  const std::string service = kMonitorService;
  control.Add(service + "ListStreams", Role::kViewer,
              Unary<v1::ListStreamsRequest, v1::ListStreamsResponse>(
                  [streams](const auto& request, const Caller&) {
                    return ListStreams(*streams, request);
                  }));
  const auto watchers = std::make_shared<std::atomic<int>>(0);
  control.Add(service + "WatchStream", Role::kViewer,
              Watching<v1::WatchStreamRequest>(
                  watchers, [streams](const auto& request, auto& call) {
                    return WatchStream(*streams, request, call);
                  }));
  control.Add(service + "WatchAll", Role::kViewer,
              Watching<v1::WatchAllRequest>(
                  watchers, [streams](const auto& request, auto& call) {
                    return WatchAll(*streams, request, call);
                  }));
}

}  // namespace tactus::internal::server
