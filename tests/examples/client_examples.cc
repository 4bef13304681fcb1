// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <chrono>
#include <memory>
#include <string>

#include "client/drivers/replay_driver.h"
#include "client/drivers/sim_driver.h"
#include "client/drivers/skin_driver.h"
#include "client/stream/answers.h"
#include "client/stream/channel.h"
#include "client/stream/contact_stream.h"
#include "client/stream/frame_encoder.h"
#include "client/stream/message_ring.h"
#include "client/stream/response_checker.h"
#include "client/stream/resumable_stream.h"
#include "client/stream/robot_id.h"
#include "client/stream/skin_frame.h"
#include "client/stream/skin_notice_text.h"
#include "client/stream/stream_history.h"
#include "client/stream/watchdog.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client::examples {

void Use(const v1::Answer& answer);
void Use(const SkinFrame& frame);
void Use(const v1::ClassifyContactResponse& response);
void Send(const v1::FrameBatch& batch);
void Send(absl::string_view bytes);

static absl::Status ChannelExample() {
#include "client/stream/channel.h.inc"
  return absl::OkStatus();
}

void Show(const std::string& class_name);

static void AnswersExample(const v1::StreamStarted& started,
                           const v1::Answer& answer) {
#include "client/stream/answers.h.inc"
}

void Print(const std::string& text);

static void SkinNoticeTextExample(const v1::StreamNotice& notice) {
#include "client/stream/skin_notice_text.h.inc"
}

static absl::Status ContactStreamExample(const SkinInfo& info,
                                         const SkinFrame& frame) {
#include "client/stream/contact_stream.h.inc"
  return absl::OkStatus();
}

static absl::Status FrameEncoderExample(const SkinInfo& info,
                                        const SkinFrame& frame,
                                        ContactStream* stream) {
#include "client/stream/frame_encoder.h.inc"
  return absl::OkStatus();
}

static void MessageRingExample(const v1::FrameBatch& message, int size) {
#include "client/stream/message_ring.h.inc"
}

static absl::Status ResumableStreamExample(const SkinInfo& info,
                                           const SkinFrame& frame) {
#include "client/stream/resumable_stream.h.inc"
  return absl::OkStatus();
}

static void StreamHistoryExample(const v1::StreamConfig& config,
                                 const v1::StreamStarted& started,
                                 v1::FrameBatch batch,
                                 const v1::ClassifyContactResponse& answer) {
#include "client/stream/stream_history.h.inc"
}

static absl::Status ResponseCheckerExample(
    const v1::ClassifyContactRequest& request,
    const v1::ClassifyContactResponse& response) {
#include "client/stream/response_checker.h.inc"
  return absl::OkStatus();
}

static void RobotIdExample(const v1::StreamConfig& config,
                           grpc::ClientContext& context) {
#include "client/stream/robot_id.h.inc"
}

static absl::Status SkinFrameExample() {
#include "client/stream/skin_frame.h.inc"
  return absl::OkStatus();
}

static absl::Status WatchdogExample(
    grpc::ClientContext& context,
    grpc::ClientReaderWriter<v1::ClassifyContactRequest,
                             v1::ClassifyContactResponse>* rpc,
    const v1::ClassifyContactRequest& request) {
#include "client/stream/watchdog.h.inc"
  return absl::OkStatus();
}

static void ReplayDriverExample() {
#include "client/drivers/replay_driver.h.inc"
}

static void SimDriverExample() {
#include "client/drivers/sim_driver.h.inc"
}

static absl::Status SkinDriverExample(SkinDriver& driver) {
#include "client/drivers/skin_driver.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::client::examples
