#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/base/status_macros.h"
#include "server/contact_log/contact_recorder.h"
#include "server/monitor/watched_stream.h"
#include "server/registry/default_bundle.h"
#include "server/registry/model_registry.h"
#include "server/session/stream_session.h"
#include "server/session/tap_pair.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/rendered_frames.h"
#include "tests/bench/timing.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

constexpr int kTrials = 8;
// A watcher reads 30 times a second of a stream at 100 Hz.
constexpr size_t kFramesPerRead = 3;

// Who sees a stream beside its robot.
enum class Seen { kByNobody, kIfAsked, kByWatcher, kKept };

v1::ClassifyContactRequest ConfigOf(const SkinModel& skin) {
  v1::ClassifyContactRequest request;
  v1::StreamConfig& config = *request.mutable_config();
  config.mutable_geometry()->set_layout(skin.layout.name);
  config.set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
  config.set_with_poses(true);
  return request;
}

// A message for each frame, as robots send them.
std::vector<v1::ClassifyContactRequest> MessagesOf(const RenderedTrial& trial) {
  std::vector<v1::ClassifyContactRequest> messages(trial.frames());
  for (int t = 0; t < trial.frames(); ++t) {
    v1::FrameBatch& batch = *messages[t].mutable_frames();
    batch.set_first_sequence(t + 1);
    batch.set_first_capture_time_ns(int64_t{10'000'000} * (t + 1));
    batch.set_frame_count(1);
    const auto taxels = trial.taxels_of(t);
    batch.set_taxels(taxels.data(), taxels.size_bytes());
    const Pose& pose = trial.poses[t];
    for (const double x : pose.position) batch.add_poses(x);
    for (const double x : pose.orientation.coeffs()) batch.add_poses(x);
  }
  return messages;
}

// Takes what was recorded, as the thread that writes it would.
class NoDisk final : public server::RecordingSink {
 public:
  explicit NoDisk(server::ChunkPool* pool) : pool_(*pool) {}
  bool TryTake(server::FinishedRecording& recording) override {
    recording.GiveBack(pool_);
    return true;
  }
  void Take(server::FinishedRecording& recording) override {
    recording.GiveBack(pool_);
  }
  void OnLeftOut() override {}

 private:
  server::ChunkPool& pool_;
};

class WatchedBenchmark : public Benchmark {
 public:
  const char* name() const override { return "watched"; }
  const char* description() const override {
    return "What it costs a stream that others may watch it, that they do, and "
           "that its contacts are kept";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_RETURN_IF_ERROR(
        models_.AddBuiltIn("default", server::DefaultBundle()));
    TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
    TACTUS_ASSIGN_OR_RETURN(const auto trials, WorldTrials(skin, kTrials));
    config_ = ConfigOf(skin);
    for (const RenderedTrial& trial : trials) {
      trials_.push_back(MessagesOf(trial));
    }
    std::vector<double> nobody;
    std::vector<double> asked;
    std::vector<double> watched;
    std::vector<double> kept;
    for (int i = 0; i < (quick ? 2 : 41); ++i) {
      for (auto [seen, times] : {std::pair(Seen::kByNobody, &nobody),
                                 std::pair(Seen::kIfAsked, &asked),
                                 std::pair(Seen::kByWatcher, &watched),
                                 std::pair(Seen::kKept, &kept)}) {
        TACTUS_ASSIGN_OR_RETURN(const double ns, MeasureFrame(seen));
        // The first round warms the caches.
        if (i > 0) times->push_back(ns);
      }
    }
    const double alone = Percentile(nobody, 0.5);
    const auto row = [alone](const char* name, std::vector<double> times) {
      return BenchRow{.name = name,
                      .unit = "ns",
                      .ours = Percentile(times, 0.5),
                      .peer = alone,
                      .peer_name = "the same stream, which nobody can see"};
    };
    return std::vector<BenchRow>{row("watched/unwatched", asked),
                                 row("watched/watched", watched),
                                 row("watched/kept", kept)};
  }

 private:
  // Processor time of a message, without its parsing and its writing.
  absl::StatusOr<double> MeasureFrame(Seen seen) {
    double seconds = 0;
    size_t frames = 0;
    for (const auto& messages : trials_) {
      server::StreamSession session(&models_, {.stream_id = "1"});
      TACTUS_RETURN_IF_ERROR(session.OnRequest(config_));
      v1::OpenStream description;
      session.Describe(&description);
      server::WatchedStream stream(std::move(description));
      server::WatchedStream::Cursor cursor;
      auto recorded = std::make_shared<v1::RecordedStream>();
      *recorded->mutable_config() = config_.config();
      server::ContactRecorder recorder(&pool_, &sink_, recorded);
      server::TapPair taps(&stream, &recorder);
      if (seen != Seen::kByNobody) session.SetTap(&stream);
      if (seen == Seen::kKept) session.SetTap(&taps);
      if (seen == Seen::kByWatcher) stream.AddWatcher();
      for (const auto& message : messages) {
        const double start = ThreadSeconds();
        stream.BeginMessage(1);
        TACTUS_RETURN_IF_ERROR(session.OnRequest(message));
        session.EndRequest(1, 2);
        if (seen != Seen::kByNobody) {
          stream.EndMessage({.frames = session.contacts()->frames()}, 2);
        }
        if (seen == Seen::kKept) recorder.EndMessage(&message.frames(), 2);
        session.responses().StartWrite(3);
        session.responses().FinishWrite();
        seconds += ThreadSeconds() - start;
        if (++frames % kFramesPerRead != 0 || seen != Seen::kByWatcher)
          continue;
        v1::StreamUpdate update;
        stream.ReadNew(3, true, &cursor, &update);
        stream.Ask();
      }
    }
    return seconds * 1e9 / static_cast<double>(frames);
  }

  server::ModelRegistry models_;
  server::ChunkPool pool_{64};
  NoDisk sink_{&pool_};
  v1::ClassifyContactRequest config_;
  std::vector<std::vector<v1::ClassifyContactRequest>> trials_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeWatchedBenchmark() {
  return std::make_unique<WatchedBenchmark>();
}

}  // namespace tactus::internal::client
