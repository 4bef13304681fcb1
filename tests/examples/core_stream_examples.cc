// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <memory>

#include "core/base/status_macros.h"
#include "core/stream/answer_sink.h"
#include "core/stream/answer_writer.h"
#include "core/stream/contact_session.h"
#include "core/stream/frame_decoder.h"
#include "core/stream/skin_notice.h"
#include "core/stream/spare_messages.h"
#include "core/stream/stream_settings.h"
#include "core/stream/stream_started.h"
#include "core/stream/stream_tap.h"

namespace tactus::internal::examples {

static void AnswerSinkExample(AnswerWriter& writer, ContactPipeline& pipeline,
                              AnswerSink& sink) {
#include "core/stream/answer_sink.h.inc"
}

static void AnswerWriterExample(AnswerWriter& writer, ContactPipeline& pipeline,
                                const FrameView& frame, uint64_t sequence,
                                int64_t time_ns, v1::Answer* answer) {
#include "core/stream/answer_writer.h.inc"
}

static void SpareMessagesExample(v1::Answer* answer) {
#include "core/stream/spare_messages.h.inc"
}

static absl::Status ContactSessionExample(
    const StreamSettings& settings,
    const std::shared_ptr<const CompiledModel>& model, AnswerSink& sink,
    const v1::FrameBatch& batch) {
#include "core/stream/contact_session.h.inc"
  return absl::OkStatus();
}

static void StreamTapExample(ContactSession& session, StreamTap& tap) {
#include "core/stream/stream_tap.h.inc"
}

static absl::Status FrameDecoderExample(const StreamSettings& settings,
                                        const v1::FrameBatch& batch,
                                        ContactPipeline& pipeline) {
#include "core/stream/frame_decoder.h.inc"
  return absl::OkStatus();
}

static void SkinNoticeExample(const SkinRange& range, SkinRangeWatch& watch,
                              AnswerSink* sink) {
#include "core/stream/skin_notice.h.inc"
}

static void StreamSettingsExample(const v1::StreamConfig& config) {
#include "core/stream/stream_settings.h.inc"
}

static void StreamStartedExample(const StreamSettings& settings,
                                 const CompiledModel* model) {
#include "core/stream/stream_started.h.inc"
}

}  // namespace tactus::internal::examples
