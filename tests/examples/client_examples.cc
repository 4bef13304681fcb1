// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <chrono>
#include <memory>
#include <string>

#include "client/drivers/replay_driver.h"
#include "client/drivers/sim_driver.h"
#include "client/drivers/skin_driver.h"
#include "client/stream/channel.h"
#include "client/stream/contact_stream.h"
#include "client/stream/frame_encoder.h"
#include "client/stream/message_ring.h"
#include "client/stream/response_checker.h"
#include "client/stream/resumable_stream.h"
#include "client/stream/robot_id.h"
#include "client/stream/skin_frame.h"
#include "client/stream/stream_history.h"
#include "client/stream/watchdog.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::client::examples {

void Use(const v1::Posterior& posterior);
void Use(const SkinFrame& frame);
void Use(const v1::ClassifyContactResponse& response);
void Send(const v1::FrameBatch& batch);
void Send(absl::string_view bytes);

void ChannelExample() { const auto channel = MakeChannel("127.0.0.1:50051"); }

absl::Status TlsChannelExample() {
  TACTUS_ASSIGN_OR_RETURN(const std::string roots,
                          ReadRootCertificates("ca.crt"));
  const auto safe = MakeChannel("arm.lab:50051", {.tls_roots = roots});
  return absl::OkStatus();
}

absl::Status ContactStreamExample(const SkinInfo& info,
                                  const SkinFrame& frame) {
  TACTUS_ASSIGN_OR_RETURN(
      auto stream,
      ContactStream::Open(MakeChannel("127.0.0.1:50051"), MakeConfig(info),
                          [](const auto& response) {
                            if (response.has_posterior()) {
                              Use(response.posterior());
                            }
                          }));
  FrameEncoder encoder(info, {});
  encoder.Add(frame);
  TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
  TACTUS_ASSIGN_OR_RETURN(const v1::Posterior answer, stream->EndTrial());
  TACTUS_RETURN_IF_ERROR(stream->Close());
  return absl::OkStatus();
}

absl::Status FrameEncoderExample(const SkinInfo& info, const SkinFrame& frame,
                                 ContactStream* stream) {
  FrameEncoder encoder(info, {.sparse = true});
  encoder.Add(frame);
  TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
  encoder.Clear();
  return absl::OkStatus();
}

void MessageRingExample(const v1::FrameBatch& message, int size) {
  MessageRing ring(limits::kMaxReplayBytes);
  if (char* bytes = ring.Append(message.ByteSizeLong())) {
    message.SerializeToArray(bytes, size);
  }
  for (auto at = ring.begin(); at != ring.end(); at = ring.Next(at)) {
    Send(ring.At(at));
  }
  ring.PopFront();
}

absl::Status ResumableStreamExample(const SkinInfo& info,
                                    const SkinFrame& frame) {
  TACTUS_ASSIGN_OR_RETURN(
      auto stream,
      ResumableStream::Open(MakeChannel("arm.lab:50051"), MakeConfig(info),
                            [](const auto& response) { Use(response); },
                            {.resume_for = std::chrono::seconds(30)}));
  FrameEncoder encoder(info, {});
  encoder.Add(frame);
  TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
  TACTUS_ASSIGN_OR_RETURN(const v1::Posterior answer, stream->EndTrial());
  TACTUS_RETURN_IF_ERROR(stream->Close());
  return absl::OkStatus();
}

void StreamHistoryExample(const v1::StreamConfig& config,
                          const v1::StreamStarted& started,
                          v1::FrameBatch batch,
                          const v1::ClassifyContactResponse& posterior) {
  StreamHistory history(config, started, limits::kMaxReplayBytes);
  history.Add(batch);  // before it is sent
  if (const auto* response = history.Take(posterior)) Use(*response);
  // The connection is lost.
  history.BeginStream();
  while (history.NextUnsent(&batch)) Send(batch);
}

absl::Status ResponseCheckerExample(
    const v1::ClassifyContactRequest& request,
    const v1::ClassifyContactResponse& response) {
  ResponseChecker checker;
  checker.OnSent(request);  // before the request is written
  TACTUS_RETURN_IF_ERROR(checker.Check(response));
  return absl::OkStatus();
}

void RobotIdExample(const v1::StreamConfig& config,
                    grpc::ClientContext& context) {
  if (IsRobotId(config.client_id())) {
    context.AddMetadata(kRobotIdKey, config.client_id());
  }
}

absl::Status SkinFrameExample() {
  SkinInfo info;
  TACTUS_ASSIGN_OR_RETURN(info.layout, LayoutPreset("cody-forearm"));
  info.scale = 0.001;  // values are millinewtons

  // A skin that is no preset.
  info.layout = {.name = "my-palm",
                 .rows = 8,
                 .columns = 8,
                 .row_pitch_m = 0.005,
                 .column_pitch_m = 0.005,
                 .taxel_area_m2 = 25e-6,
                 .unit = TaxelUnit::kNewton,
                 .contact_threshold = 0.01,
                 .onset_threshold = 0.02};
  return absl::OkStatus();
}

absl::Status WatchdogExample(
    grpc::ClientContext& context,
    grpc::ClientReaderWriter<v1::ClassifyContactRequest,
                             v1::ClassifyContactResponse>* rpc,
    const v1::ClassifyContactRequest& request) {
  Watchdog watchdog([&] { context.TryCancel(); });
  watchdog.Start("config", std::chrono::seconds(10));
  rpc->Write(request);  // returns once it is cancelled
  watchdog.Stop();
  TACTUS_RETURN_IF_ERROR(watchdog.status());
  return absl::OkStatus();
}

void ReplayDriverExample() {
  ReplayDriver driver("vitac.h5", {}, {.max_trials = 10});
}

void SimDriverExample() { SimDriver driver({.seed = 7}, /*trials=*/40, {}); }

absl::Status SkinDriverExample(SkinDriver& driver) {
  TACTUS_ASSIGN_OR_RETURN(SkinInfo info, driver.Configure());
  TACTUS_RETURN_IF_ERROR(driver.Activate());
  SkinFrame frame;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(ReadResult result, driver.Read(frame));
    if (result == ReadResult::kEndOfData) break;
    if (result == ReadResult::kFrame) Use(frame);
  }
  TACTUS_RETURN_IF_ERROR(driver.Finalise());
  return absl::OkStatus();
}

}  // namespace tactus::client::examples
