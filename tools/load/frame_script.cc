#include "tools/load/frame_script.h"

#include <algorithm>
#include <cmath>
#include <optional>
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
// Fraction of frames that touch, unless none does: scripts are in memory.
constexpr double kLeastTouched = 0.02;
// The tag and length of `frames`, then two fields of a number each.
constexpr size_t kMaxHeaderBytes = 1 + 5 + 2 * (1 + 10);

std::string BodyOf(const FrameEncoder& encoder) {
  v1::FrameBatch batch = encoder.request().frames();
  batch.clear_first_sequence();
  batch.clear_first_capture_time_ns();
  return batch.SerializeAsString();
}

// The frames of one simulated trial: some untouched, then a contact, which ends
// with the last touched frame.
struct Contact {
  std::vector<SkinFrame> frames;
  size_t onset = 0;
  size_t end = 0;
};

bool IsTouched(const SkinInfo& info, const SkinFrame& frame) {
  const double threshold = info.layout.contact_threshold / info.scale;
  return std::ranges::any_of(
      frame.u16, [threshold](uint16_t value) { return value >= threshold; });
}

// `onset`: where the simulated object begins to touch.
Contact MakeContact(const SkinInfo& info, std::vector<SkinFrame> frames,
                    size_t onset) {
  const auto last = std::find_if(
      frames.rbegin(), frames.rend(),
      [&](const SkinFrame& frame) { return IsTouched(info, frame); });
  const auto end = static_cast<size_t>(frames.rend() - last);
  return {
      .frames = std::move(frames), .onset = onset, .end = std::max(onset, end)};
}

// All frames of all contacts, or such a choice that a fraction of them touches.
std::vector<const SkinFrame*> Choose(const std::vector<Contact>& contacts,
                                     std::optional<double> fraction) {
  std::vector<const SkinFrame*> chosen;
  // Untouched frames that are owed; contacts have whole numbers of them.
  double owed = 0;
  for (const Contact& contact : contacts) {
    if (!fraction) {
      for (const SkinFrame& frame : contact.frames) chosen.push_back(&frame);
      continue;
    }
    const auto touched = static_cast<double>(contact.end - contact.onset);
    owed += *fraction == 0 ? static_cast<double>(contact.onset)
                           : touched * (1 - *fraction) / *fraction;
    for (size_t i = 0; owed >= 1; ++i, --owed) {
      chosen.push_back(&contact.frames[i % contact.onset]);
    }
    if (*fraction == 0) continue;
    for (size_t i = contact.onset; i < contact.end; ++i) {
      chosen.push_back(&contact.frames[i]);
    }
  }
  return chosen;
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
  if (options.touched_fraction && *options.touched_fraction != 0 &&
      !(*options.touched_fraction >= kLeastTouched &&
        *options.touched_fraction <= 1)) {
    return InvalidConfig("touched fraction", *options.touched_fraction,
                         absl::StrCat("0, or ", kLeastTouched, " to 1"));
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

  std::vector<Contact> contacts;
  std::vector<SkinFrame> trial;
  SkinFrame frame;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
    if (result == ReadResult::kEndOfData) break;
    if (result == ReadResult::kFrame) {
      trial.push_back(frame);
    } else if (result == ReadResult::kEndOfTrial) {
      contacts.push_back(MakeContact(info, std::move(trial), untouched));
      trial.clear();
    }
  }
  const auto frames = Choose(contacts, options.touched_fraction);
  size_t touched = 0;
  for (const Contact& contact : contacts)
    touched += contact.end - contact.onset;
  if (options.touched_fraction == 0) touched = 0;
  script.touched_fraction_ =
      static_cast<double>(touched) / static_cast<double>(frames.size());
  TACTUS_RETURN_IF_ERROR(script.Encode(info, options, frames));
  return script;
}

absl::Status FrameScript::Encode(const SkinInfo& info, const Options& options,
                                 const std::vector<const SkinFrame*>& frames) {
  FrameEncoder encoder(info, {.sparse = options.sparse});
  for (const SkinFrame* frame : frames) {
    encoder.Add(*frame);
    if (encoder.frames() < options.frames_per_message) continue;
    bodies_.push_back(BodyOf(encoder));
    const size_t size = bodies_.back().size() + kMaxHeaderBytes;
    if (size > limits::kMaxMessageBytes) {
      return InvalidConfig("frames per message", options.frames_per_message,
                           absl::StrCat("fewer: a message has at most ",
                                        limits::kMaxMessageBytes, " bytes"));
    }
    encoder.Clear();
  }
  return absl::OkStatus();
}

void FrameScript::AppendMessage(size_t position, uint64_t first_sequence,
                                std::string* out) const {
  const std::string& body = bodies_[position % bodies_.size()];
  uint8_t numbers[2 * (1 + 10)];
  uint8_t* end = WireFormatLite::WriteUInt64ToArray(
      v1::FrameBatch::kFirstSequenceFieldNumber, first_sequence, numbers);
  end = WireFormatLite::WriteInt64ToArray(
      v1::FrameBatch::kFirstCaptureTimeNsFieldNumber,
      static_cast<int64_t>(first_sequence) * frame_period_ns_, end);
  const size_t size = end - numbers;

  uint8_t header[kMaxHeaderBytes];
  uint8_t* header_end = WireFormatLite::WriteTagToArray(
      v1::ClassifyContactRequest::kFramesFieldNumber,
      WireFormatLite::WIRETYPE_LENGTH_DELIMITED, header);
  header_end = CodedOutputStream::WriteVarint32ToArray(
      static_cast<uint32_t>(size + body.size()), header_end);
  header_end = std::copy(numbers, end, header_end);
  out->append(header, header_end);
  out->append(body);
}

}  // namespace tactus::internal::client
