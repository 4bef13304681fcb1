#include "client/front/remote_stream.h"

#include <atomic>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/front/answer_delivery.h"
#include "client/front/skin_convert.h"
#include "client/stream/frame_encoder.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// What a message has besides its frames, at the most.
constexpr size_t kMessageOverheadBytes = 256;

// `Link` is ContactStream or ResumableStream.
template <typename Link>
class RemoteStream : public Stream {
 public:
  RemoteStream(const SkinInfo& skin, const StreamOptions& options)
      : skin_(skin),
        frames_per_message_(options.frames_per_message),
        delivery_(options),
        encoder_(skin, {}) {}

  // Once, with what opens a link for a callback.
  template <typename Open>
  absl::Status Begin(Open open) {
    auto link = open([this](const auto& r) { delivery_.OnResponse(r); });
    if (!link.ok()) return link.status();
    link_ = *std::move(link);
    delivery_.Begin(link_->started());
    return absl::OkStatus();
  }

  const StreamInfo& info() const override {
    return delivery_.converter().info();
  }

  absl::Status Push(const Frame& frame) override {
    TACTUS_RETURN_IF_ERROR(ToSkinFrame(frame, skin_, frame_));
    if (encoder_.frames() > 0 &&
        (frame.missing_before > 0 || !HasRoomForAnother())) {
      TACTUS_RETURN_IF_ERROR(Flush());
    }
    encoder_.Skip(frame.missing_before);
    encoder_.Add(frame_);
    ++frames_;
    return encoder_.frames() < static_cast<uint32_t>(frames_per_message_)
               ? absl::OkStatus()
               : Flush();
  }

  absl::StatusOr<Answer> EndTrial() override {
    TACTUS_RETURN_IF_ERROR(Flush());
    TACTUS_ASSIGN_OR_RETURN(const v1::Answer answer, link_->EndTrial());
    Answer out;
    delivery_.converter().Convert(answer, out);
    return out;
  }

  absl::Status Close() override {
    const absl::Status flushed = Flush();
    const absl::Status closed = link_->Close();
    return closed.ok() ? flushed : closed;
  }

  bool Poll(Event& event) override { return delivery_.events().Poll(event); }
  bool ended() override { return link_->ended(); }
  void Cancel() override { link_->Cancel(); }

  bool resuming() override {
    if constexpr (requires { link_->resuming(); }) return link_->resuming();
    return false;
  }

  StreamStatistics statistics() override {
    StreamStatistics statistics;
    statistics.frames = frames_;
    statistics.events_dropped = delivery_.events().dropped();
    if constexpr (requires { link_->statistics(); }) {
      const auto resumed = link_->statistics();
      statistics.resumed = resumed.resumed;
      statistics.frames_sent_again = resumed.replayed_frames;
      statistics.without_beginning = resumed.without_beginning;
    }
    return statistics;
  }

 private:
  bool HasRoomForAnother() const {
    const size_t bytes = encoder_.bytes();
    return bytes + bytes / encoder_.frames() + kMessageOverheadBytes <=
           limits::kMaxMessageBytes;
  }

  absl::Status Flush() {
    if (encoder_.frames() == 0) return absl::OkStatus();
    const absl::Status status = link_->Send(encoder_.request());
    encoder_.Clear();
    return status;
  }

  const SkinInfo skin_;
  const int frames_per_message_;
  AnswerDelivery delivery_;
  FrameEncoder encoder_;
  SkinFrame frame_;
  std::atomic<uint64_t> frames_ = 0;
  // The last member, because it calls back until it is gone.
  std::unique_ptr<Link> link_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Stream>> OpenRemoteStream(
    const std::shared_ptr<grpc::Channel>& channel, const Skin& skin,
    const StreamOptions& options, const ResumeOptions& resume) {
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, ToSkinInfo(skin));
  TACTUS_ASSIGN_OR_RETURN(const v1::StreamConfig config,
                          ToConfig(info, options));
  const int most = static_cast<int>(limits::kMaxFramesPerMessage);
  if (options.frames_per_message < 1 || options.frames_per_message > most) {
    return InvalidConfig("frames_per_message", options.frames_per_message,
                         absl::StrCat("1 to ", most));
  }
  if (resume.resume_for.count() > 0) {
    auto stream =
        std::make_unique<RemoteStream<ResumableStream>>(info, options);
    TACTUS_RETURN_IF_ERROR(stream->Begin([&](auto on_response) {
      return ResumableStream::Open(channel, config, on_response, resume);
    }));
    return stream;
  }
  auto stream = std::make_unique<RemoteStream<ContactStream>>(info, options);
  TACTUS_RETURN_IF_ERROR(stream->Begin([&](auto on_response) {
    return ContactStream::Open(channel, config, on_response, resume.timeouts,
                               resume.token);
  }));
  return stream;
}

}  // namespace tactus::internal::client
