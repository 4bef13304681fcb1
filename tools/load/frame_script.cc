#include "tools/load/frame_script.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/drivers/sim_driver.h"
#include "client/stream/frame_encoder.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/wire_format_lite.h"

namespace tactus::internal::client {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedOutputStream;

// Simulated skins are read at this rate, Hz.
constexpr double kRateHz = 100;
// The tag and length of `frames`, then two fields of a number each.
constexpr size_t kMaxHeaderBytes = 1 + 5 + 2 * (1 + 10);

grpc::Slice BodyOf(const FrameEncoder& encoder) {
  v1::FrameBatch batch = encoder.request().frames();
  batch.clear_first_sequence();
  batch.clear_first_capture_time_ns();
  return grpc::Slice(batch.SerializeAsString());
}

}  // namespace

absl::StatusOr<FrameScript> FrameScript::Create(const Options& options) {
  if (options.frames_per_message < 1 ||
      options.frames_per_message > limits::kMaxFramesPerMessage) {
    return InvalidConfig("frames per message", options.frames_per_message,
                         absl::StrCat("1 to ", limits::kMaxFramesPerMessage));
  }
  const auto untouched =
      static_cast<int>(std::lround(options.untouched_seconds * kRateHz));
  if (untouched < 1 || untouched > limits::kMaxLeadInFrames) {
    return InvalidConfig(
        "untouched seconds", options.untouched_seconds,
        absl::StrCat("a frame to ", limits::kMaxLeadInFrames / kRateHz));
  }
  SimDriver driver({.seed = options.seed, .lead_in_frames = untouched},
                   options.contacts, {});
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
  TACTUS_RETURN_IF_ERROR(driver.Activate());
  FrameScript script;
  script.config_ = MakeConfig(info);
  script.frame_period_ns_ = std::llround(1e9 / info.sample_rate_hz);
  script.config_.set_cadence(v1::RESULT_CADENCE_EVERY_N_FRAMES);
  script.config_.set_result_interval_frames(options.frames_per_message);

  script.untouched_messages_ = untouched / options.frames_per_message;

  FrameEncoder encoder(info, {.sparse = options.sparse});
  SkinFrame frame;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
    if (result == ReadResult::kEndOfData) break;
    if (result != ReadResult::kFrame) continue;
    encoder.Add(frame);
    if (encoder.frames() < options.frames_per_message) continue;
    script.bodies_.push_back(BodyOf(encoder));
    const size_t size = script.bodies_.back().size() + kMaxHeaderBytes;
    if (size > limits::kMaxMessageBytes) {
      return InvalidConfig("frames per message", options.frames_per_message,
                           absl::StrCat("fewer: a message has at most ",
                                        limits::kMaxMessageBytes, " bytes"));
    }
    encoder.Clear();
  }
  return script;
}

grpc::ByteBuffer FrameScript::Message(size_t position,
                                      uint64_t first_sequence) const {
  const grpc::Slice& body = bodies_[position % bodies_.size()];
  uint8_t numbers[2 * (1 + 10)];
  uint8_t* end = WireFormatLite::WriteUInt64ToArray(
      v1::FrameBatch::kFirstSequenceFieldNumber, first_sequence, numbers);
  end = WireFormatLite::WriteInt64ToArray(
      v1::FrameBatch::kFirstCaptureTimeNsFieldNumber,
      static_cast<int64_t>(first_sequence) * frame_period_ns_, end);
  const size_t size = end - numbers;

  uint8_t header[kMaxHeaderBytes];
  uint8_t* out = WireFormatLite::WriteTagToArray(
      v1::ClassifyContactRequest::kFramesFieldNumber,
      WireFormatLite::WIRETYPE_LENGTH_DELIMITED, header);
  out = CodedOutputStream::WriteVarint32ToArray(
      static_cast<uint32_t>(size + body.size()), out);
  out = std::copy(numbers, end, out);
  const grpc::Slice slices[] = {grpc::Slice(header, out - header), body};
  return grpc::ByteBuffer(slices, 2);
}

}  // namespace tactus::internal::client
