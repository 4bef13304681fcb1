#include "tools/ros2/bridge.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;

// How long a call of DDS may wait, and so a signal.
constexpr milliseconds kWait{50};
// Joint values of a second at 1 kHz, while the stream waits.
constexpr DdsQos kPoseQos = {.reliable = false, .depth = 1'000};
// Markers vanish if no answer replaces them.
constexpr double kMarkerSeconds = 0.5;
// A gap of this many periods is a loss.
constexpr double kLossPeriods = 1.75;

// Another attempt would end in the same way.
bool IsForGood(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
      return true;
    default:
      return false;
  }
}

int64_t NowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Bridge::Bridge(DdsNode* node, BridgeOptions options, OnNews on_news)
    : node_(node), options_(std::move(options)), on_news_(std::move(on_news)) {}

absl::Status Bridge::Run() {
  TACTUS_ASSIGN_OR_RETURN(
      skin_, SkinOf(options_.file, /*with_poses=*/options_.poses != nullptr));
  TACTUS_RETURN_IF_ERROR(Advertise());
  TACTUS_RETURN_IF_ERROR(OpenStream());
  TACTUS_RETURN_IF_ERROR(WaitForType());
  if (stop_) return Close();
  TACTUS_ASSIGN_OR_RETURN(
      skin_topic_,
      SkinTopic::Make(options_.file, options_.type, options_.definition));
  TACTUS_ASSIGN_OR_RETURN(
      reader_, node_->Subscribe(options_.topic, options_.type, options_.qos));
  if (options_.poses != nullptr) {
    TACTUS_ASSIGN_OR_RETURN(pose_reader_,
                            node_->Subscribe(options_.pose_topic,
                                             options_.poses->type(), kPoseQos));
  }
  News(absl::StrCat(options_.topic, " is ", options_.type, ", in domain ",
                    node_->domain()));
  const absl::Status status = Loop();
  const absl::Status closed = Close();
  return status.ok() ? closed : status;
}

absl::Status Bridge::Advertise() {
  TACTUS_ASSIGN_OR_RETURN(
      contacts_,
      node_->Advertise(options_.name + "/contacts", kContactsType, {}));
  TACTUS_ASSIGN_OR_RETURN(
      events_, node_->Advertise(options_.name + "/events", kEventType, {}));
  TACTUS_ASSIGN_OR_RETURN(
      markers_, node_->Advertise(options_.name + "/markers", kMarkersType, {}));
  TACTUS_ASSIGN_OR_RETURN(
      diagnostics_, node_->Advertise("/diagnostics", kDiagnosticsType, {}));
  return absl::OkStatus();
}

absl::Status Bridge::WaitForType() {
  bool told = false;
  while (options_.type.empty() && !stop_) {
    TACTUS_ASSIGN_OR_RETURN(options_.type, node_->TypeOf(options_.topic));
    if (!options_.type.empty()) break;
    if (!told) News(absl::StrCat("waits for a publisher of ", options_.topic));
    told = true;
    node_->Wait(kWait);
    TACTUS_RETURN_IF_ERROR(Watch());
  }
  return absl::OkStatus();
}

absl::Status Bridge::Loop() {
  DdsMessage message;
  while (!stop_) {
    node_->Wait(kWait);
    // Those that were published before a frame have come before it.
    TakePoses();
    while (!stop_ && reader_->Take(message)) {
      TakePoses();
      TACTUS_RETURN_IF_ERROR(TakeMessage(message));
    }
    TACTUS_RETURN_IF_ERROR(Watch());
  }
  return absl::OkStatus();
}

void Bridge::TakePoses() {
  DdsMessage message;
  while (pose_reader_ != nullptr && pose_reader_->Take(message)) {
    const absl::Status taken = options_.poses->Take(message);
    if (taken.ok()) continue;
    Refuse(options_.pose_topic, taken);
  }
}

bool Bridge::FindPose() {
  if (options_.poses == nullptr) return true;
  const auto pose = options_.poses->PoseAt(frame_.capture_time_ns);
  const std::string problem = pose ? "" : options_.poses->Problem();
  // The text of a lasting problem has numbers that change.
  if (pose_problem_.empty() != problem.empty()) {
    News(pose ? absl::StrCat("poses come again; ", without_pose_,
                             " frames lost without poses so far")
              : absl::StrCat("frames are lost without poses: ", problem));
  }
  pose_problem_ = problem;
  if (!pose) {
    ++without_pose_;
    return false;
  }
  frame_.pose = *pose;
  return true;
}

void Bridge::Refuse(const std::string& topic, const absl::Status& status) {
  ++refused_;
  const std::string refusal(status.message());
  if (refusal != last_refusal_) {
    News(absl::StrCat("a message of ", topic, " is refused: ", refusal));
  }
  last_refusal_ = refusal;
}

absl::Status Bridge::TakeMessage(const DdsMessage& message) {
  const auto made = skin_topic_->Read(message, frame_);
  if (!made.ok()) {
    Refuse(options_.topic, made.status());
    return absl::OkStatus();
  }
  if (!*made) {
    if (skin_topic_->idle_frames_left() == 0) {
      News("the baseline is taken from the idle frames");
    }
    return absl::OkStatus();
  }
  if (!FindPose()) return absl::OkStatus();
  last_frame_ = Clock::now();
  return PushFrame();
}

absl::Status Bridge::PushFrame() {
  const int64_t silence_ns = std::chrono::nanoseconds(options_.silence).count();
  if (last_time_ns_) {
    const int64_t gap_ns = frame_.capture_time_ns - *last_time_ns_;
    if (gap_ns <= -silence_ns) {
      // A clock was set, or a bag is played again.
      News("the frames' times have gone back; a new stream begins");
      const absl::Status closed = Close();
      if (!closed.ok()) TACTUS_RETURN_IF_ERROR(LoseStream(closed));
      TACTUS_RETURN_IF_ERROR(OpenStream());
    } else if (gap_ns <= 0) {
      ++refused_;
      return absl::OkStatus();
    } else if (gap_ns > silence_ns) {
      TACTUS_RETURN_IF_ERROR(EndTrial());
    } else {
      const double periods =
          static_cast<double>(gap_ns) / 1e9 * skin_.sample_rate_hz;
      if (periods >= kLossPeriods) {
        frame_.missing_before =
            static_cast<uint64_t>(std::llround(periods)) - 1;
      }
    }
  }
  last_time_ns_ = frame_.capture_time_ns;
  missing_ += frame_.missing_before;
  ++frames_;
  if (stream_ == nullptr) {
    ++not_sent_;
    return absl::OkStatus();
  }
  in_trial_ = true;
  const absl::Status status = stream_->Push(frame_);
  return status.ok() ? status : LoseStream(status);
}

absl::Status Bridge::EndTrial() {
  if (stream_ == nullptr || !in_trial_) return absl::OkStatus();
  in_trial_ = false;
  const absl::Status status = stream_->EndTrial().status();
  return status.ok() ? status : LoseStream(status);
}

absl::Status Bridge::OpenStream() {
  if (stream_ != nullptr || Clock::now() < next_attempt_) {
    return absl::OkStatus();
  }
  StreamOptions options = options_.stream;
  options.on_answer = [this](const Answer& answer) { Publish(answer); };
  options.on_notice = [this](const Notice& notice) { News(notice.text); };
  auto stream = options_.open(skin_, options);
  // The model is for another skin. A stream that is lost because the server has
  // got another model has the same code, and begins anew.
  if (absl::IsFailedPrecondition(stream.status())) return stream.status();
  if (!stream.ok()) return LoseStream(stream.status());
  stream_ = *std::move(stream);
  stream_problem_.clear();
  in_trial_ = false;
  was_resuming_ = false;
  News(absl::StrCat("skin ", skin_.name, ", ", stream_->info().rows, " x ",
                    stream_->info().columns, " at ", skin_.sample_rate_hz,
                    " Hz; ", stream_->info().model_version));
  return absl::OkStatus();
}

absl::Status Bridge::LoseStream(const absl::Status& status) {
  stream_.reset();
  if (IsForGood(status)) return status;
  next_attempt_ = Clock::now() + options_.pause;
  const std::string problem(status.message());
  if (problem != stream_problem_) {
    News(absl::StrCat("no stream, another is tried: ", problem));
  }
  stream_problem_ = problem;
  return absl::OkStatus();
}

absl::Status Bridge::Watch() {
  const auto now = Clock::now();
  const bool silent = now - last_frame_ > options_.silence;
  const bool resuming = stream_ != nullptr && stream_->resuming();
  if (silent != was_silent_ && frames_ > 0) {
    News(silent ? absl::StrCat(options_.topic, " is silent")
                : absl::StrCat(options_.topic, " sends again"));
  }
  was_silent_ = silent;
  if (silent && !resuming) TACTUS_RETURN_IF_ERROR(EndTrial());
  if (resuming != was_resuming_ && stream_ != nullptr) {
    News(resuming ? "the stream is lost; frames are kept until it goes on"
                  : absl::StrCat("the stream goes on; ",
                                 stream_->statistics().frames_sent_again,
                                 " frames were sent again so far"));
  }
  was_resuming_ = resuming;
  if (stream_ != nullptr && stream_->ended()) {
    const absl::Status closed = stream_->Close();
    TACTUS_RETURN_IF_ERROR(
        LoseStream(closed.ok() ? NoResponse("the stream", 0) : closed));
  }
  TACTUS_RETURN_IF_ERROR(OpenStream());
  if (reader_ != nullptr) {
    const std::string policy = reader_->refused_policy();
    if (policy != refused_policy_ && !policy.empty()) {
      News(absl::StrCat("a publisher of ", options_.topic,
                        " does not match by its QoS: ", policy,
                        policy == "reliability" ? "; omit --reliable" : ""));
    }
    refused_policy_ = policy;
  }
  if (now >= next_diagnosis_) {
    Diagnose();
    next_diagnosis_ = now + options_.diagnosis;
  }
  return absl::OkStatus();
}

absl::Status Bridge::Close() {
  if (stream_ == nullptr) return absl::OkStatus();
  // What was lost is not waited for.
  const bool resuming = stream_->resuming();
  if (resuming) stream_->Cancel();
  const absl::Status closed = stream_->Close();
  stream_.reset();
  return resuming ? absl::OkStatus() : closed;
}

void Bridge::Publish(const Answer& answer) {
  Write(*contacts_, ContactsMessage(answer, options_.frame_id));
  for (const Event& event : answer.events) {
    Write(*events_, EventMessage(event, options_.frame_id));
  }
  if (markers_->subscribers() > 0) {
    Write(*markers_, MarkersMessage(answer, options_.frame_id, kMarkerSeconds));
  }
}

void Bridge::Write(DdsWriter& writer, const std::string& bytes) {
  if (!writer.Write(bytes).ok()) ++unwritten_;
}

void Bridge::Diagnose() {
  Diagnosis diagnosis = {.name = absl::StrCat("tactus-ros2: ", options_.topic),
                         .message = "frames are answered",
                         .hardware_id = options_.stream.client_id};
  const bool resuming = stream_ != nullptr && stream_->resuming();
  if (stream_ == nullptr) {
    diagnosis.level = Diagnosis::Level::kError;
    diagnosis.message = "no stream: " + stream_problem_;
  } else if (!pose_problem_.empty()) {
    diagnosis.level = Diagnosis::Level::kError;
    diagnosis.message = "frames are lost without poses: " + pose_problem_;
  } else if (was_silent_ || frames_ == 0) {
    diagnosis.level = Diagnosis::Level::kStale;
    diagnosis.message = "no frames come";
  } else if (resuming) {
    diagnosis.level = Diagnosis::Level::kWarning;
    diagnosis.message = "the stream is lost; frames are kept";
  }
  const auto add = [&](const char* key, const auto& value) {
    diagnosis.values.emplace_back(key, absl::StrCat(value));
  };
  add("frames", frames_);
  add("frames per second",
      static_cast<double>(frames_ - frames_diagnosed_) /
          std::chrono::duration<double>(options_.diagnosis).count());
  frames_diagnosed_ = frames_;
  add("frames missing", missing_);
  add("frames without a stream", not_sent_);
  add("frames without a pose", without_pose_);
  add("pose problem", pose_problem_);
  add("messages refused", refused_);
  add("last refusal", last_refusal_);
  add("messages not taken", unwritten_.load());
  add("publishers", reader_ == nullptr ? 0 : reader_->publishers());
  add("subscribers of contacts", contacts_->subscribers());
  if (stream_ != nullptr) {
    add("model", stream_->info().model_version);
    add("connections after the first", stream_->statistics().resumed);
  }
  Write(*diagnostics_, DiagnosticsMessage(diagnosis, NowNs()));
}

}  // namespace tactus::internal::client
