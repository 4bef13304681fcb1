#include "tools/trainctl/remote/served_model.h"

#include "absl/strings/str_cat.h"
#include "client/drivers/clock.h"

namespace tactus::internal::client {

std::string ServedModel::Open(const std::shared_ptr<grpc::Channel>& channel,
                              const SkinInfo& info, const std::string& model,
                              const std::string& token) {
  v1::StreamConfig config = MakeConfig(info);
  config.set_model(model);
  auto stream = ContactStream::Open(
      channel, config,
      [monitor = monitor_](const v1::ClassifyContactResponse& response) {
        if (!response.has_answer()) return;
        monitor->Answer(response.answer(), Clock::System().NowNs());
      },
      {}, token);
  if (!stream.ok()) {
    return absl::StrCat("no model: ", stream.status().message());
  }
  stream_ = *std::move(stream);
  encoder_.emplace(info, FrameEncoder::Options{});
  monitor_->Started(stream_->started());
  return "";
}

std::string ServedModel::Send(const SkinFrame& frame) {
  if (stream_ == nullptr) {
    monitor_->Frame(frame, 0, Clock::System().NowNs());
    return "";
  }
  encoder_->Skip(frame.missing_before);
  encoder_->Add(frame);
  monitor_->Frame(frame, encoder_->last_sequence(), Clock::System().NowNs());
  const absl::Status sent = stream_->Send(encoder_->request());
  encoder_->Clear();
  return sent.ok() && !stream_->ended() ? "" : Ended(sent);
}

std::string ServedModel::EndTrial() {
  if (stream_ == nullptr) return "";
  const auto answer = stream_->EndTrial();
  return answer.ok() ? "" : Ended(answer.status());
}

std::string ServedModel::Ended(absl::Status status) {
  if (status.ok()) status = stream_->Close();
  stream_.reset();
  return absl::StrCat("the model's stream ended, recording goes on: ",
                      status.message());
}

}  // namespace tactus::internal::client
