// The models and streams of tactus.h, on the C++ interface.
#include <cstring>
#include <deque>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "client/c/include/tactus.h"
#include "client/c/structs.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tactus/classifier.h"
#include "tactus/status.h"

struct tactus_model {
  tactus::Classifier classifier;
};

struct tactus_stream {
  std::unique_ptr<tactus::Stream> stream;
  // Keeps its memory.
  tactus::Frame frame;
  tactus::Answer answer;
  bool has_answer = false;
  std::deque<tactus::Notice> notices;

  const tactus::StreamInfo& info() const { return stream->info(); }
  size_t frame_values() const {
    return static_cast<size_t>(info().rows) * info().columns * info().axes;
  }
};

namespace tactus::internal::c {
namespace {

constexpr size_t kMaxNotices = 16;

int32_t Report(const absl::Status& status, tactus_error* error) {
  if (status.ok()) return TACTUS_OK;
  if (error != nullptr) {
    error->code = static_cast<int32_t>(status.code());
    CopyText(ReasonOf(status), error->reason);
    CopyText(status.message(), error->text);
  }
  return static_cast<int32_t>(status.code());
}

int32_t ReportText(int32_t code, const char* text, tactus_error* error) {
  if (error == nullptr) return code;
  error->code = code;
  CopyText("", error->reason);
  CopyText(text, error->text);
  return code;
}

// Nothing that is thrown below crosses the border to C.
template <typename Work>
int32_t Guarded(tactus_error* error, const Work& work) noexcept {
  try {
    return Report(work(), error);
  } catch (const std::bad_alloc&) {
    return ReportText(TACTUS_RESOURCE_EXHAUSTED, "no memory is left", error);
  } catch (...) {
    return ReportText(TACTUS_INTERNAL, "something was thrown", error);
  }
}

absl::Status Missing(absl::string_view what) {
  return InvalidConfig(what, "NULL", "given");
}

absl::Status Loaded(absl::StatusOr<Classifier> classifier,
                    tactus_model** model) {
  if (!classifier.ok()) return classifier.status();
  *model = new tactus_model{*std::move(classifier)};
  return absl::OkStatus();
}

absl::Status OpenStream(const tactus_model& model, const tactus_skin& skin_in,
                        const tactus_options* options_in,
                        tactus_stream** stream) {
  TACTUS_ASSIGN_OR_RETURN(const Skin skin, SkinFromC(skin_in));
  StreamOptions options;
  if (options_in != nullptr) {
    TACTUS_ASSIGN_OR_RETURN(options, OptionsFromC(*options_in));
  }
  auto made = std::make_unique<tactus_stream>();
  tactus_stream* const self = made.get();
  options.on_answer = [self](const Answer& answer) {
    self->answer = answer;
    self->has_answer = true;
  };
  options.on_notice = [self](const Notice& notice) {
    if (self->notices.size() == kMaxNotices) self->notices.pop_front();
    self->notices.push_back(notice);
  };
  TACTUS_ASSIGN_OR_RETURN(made->stream, model.classifier.Open(skin, options));
  *stream = made.release();
  return absl::OkStatus();
}

absl::Status PushFrame(tactus_stream& stream, const tactus_frame& frame) {
  // Before anything is copied that could be of any size.
  if (frame.count != stream.frame_values()) {
    return InvalidConfig(
        "frame.count", frame.count,
        absl::StrCat(stream.frame_values(), ", the skin's values"));
  }
  if (frame.values == nullptr) return Missing("frame.values");
  TACTUS_RETURN_IF_ERROR(FrameFromC(frame, stream.frame));
  return stream.stream->Push(stream.frame);
}

const std::vector<std::string>* ValuesOf(const tactus_stream* stream,
                                         size_t question) {
  if (stream == nullptr || question >= stream->info().questions.size()) {
    return nullptr;
  }
  return &stream->info().questions[question].values;
}

int32_t IndexOf(const std::vector<std::string>& names,
                const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1
                              : static_cast<int32_t>(found - names.begin());
}

void WriteEvent(const Event& event, const StreamInfo& info, tactus_event* out) {
  tactus_event full = TACTUS_EVENT_INIT;
  full.contact = event.contact;
  full.sequence = event.sequence;
  full.capture_time_ns = event.capture_time_ns;
  full.since_onset_ns = event.since_onset_ns;
  full.other_contact = event.other_contact;
  full.kind = static_cast<int32_t>(event.kind);
  for (size_t q = 0; q < info.questions.size(); ++q) {
    if (info.questions[q].name != event.question) continue;
    full.question = static_cast<int32_t>(q);
    full.value = IndexOf(info.questions[q].values, event.value);
  }
  CopyOut(full, out);
}

}  // namespace
}  // namespace tactus::internal::c

namespace c = tactus::internal::c;

int32_t tactus_abi(void) { return TACTUS_ABI; }
const char* tactus_version(void) { return TACTUS_VERSION; }

int32_t tactus_model_load(const char* path, tactus_model** model,
                          tactus_error* error) {
  return c::Guarded(error, [&] {
    if (model == nullptr) return c::Missing("model");
    *model = nullptr;
    if (path == nullptr) return c::Missing("path");
    return c::Loaded(tactus::Classifier::Load(path), model);
  });
}

int32_t tactus_model_parse(const void* bytes, size_t size, const char* name,
                           tactus_model** model, tactus_error* error) {
  return c::Guarded(error, [&] {
    if (model == nullptr) return c::Missing("model");
    *model = nullptr;
    if (bytes == nullptr) return c::Missing("bytes");
    if (name == nullptr) return c::Missing("name");
    return c::Loaded(tactus::Classifier::Parse(
                         {static_cast<const char*>(bytes), size}, name),
                     model);
  });
}

void tactus_model_free(tactus_model* model) { delete model; }

int32_t tactus_stream_open(const tactus_model* model, const tactus_skin* skin,
                           const tactus_options* options,
                           tactus_stream** stream, tactus_error* error) {
  return c::Guarded(error, [&] {
    if (stream == nullptr) return c::Missing("stream");
    *stream = nullptr;
    if (model == nullptr) return c::Missing("model");
    if (skin == nullptr) return c::Missing("skin");
    return c::OpenStream(*model, *skin, options, stream);
  });
}

void tactus_stream_free(tactus_stream* stream) { delete stream; }

int32_t tactus_stream_push(tactus_stream* stream, const tactus_frame* frame,
                           tactus_error* error) {
  return c::Guarded(error, [&] {
    if (stream == nullptr) return c::Missing("stream");
    stream->has_answer = false;
    if (frame == nullptr) return c::Missing("frame");
    return c::PushFrame(*stream, *frame);
  });
}

int32_t tactus_stream_end_trial(tactus_stream* stream, tactus_error* error) {
  return c::Guarded(error, [&]() -> absl::Status {
    if (stream == nullptr) return c::Missing("stream");
    stream->has_answer = false;
    TACTUS_ASSIGN_OR_RETURN(stream->answer, stream->stream->EndTrial());
    stream->has_answer = true;
    return absl::OkStatus();
  });
}

int32_t tactus_stream_close(tactus_stream* stream, tactus_error* error) {
  return c::Guarded(error, [&] {
    if (stream == nullptr) return c::Missing("stream");
    stream->has_answer = false;
    return stream->stream->Close();
  });
}

size_t tactus_stream_frame_values(const tactus_stream* stream) {
  return stream == nullptr ? 0 : stream->frame_values();
}

size_t tactus_stream_class_count(const tactus_stream* stream) {
  return stream == nullptr ? 0 : stream->info().classes.size();
}

const char* tactus_stream_class_name(const tactus_stream* stream,
                                     size_t index) {
  return index < tactus_stream_class_count(stream)
             ? stream->info().classes[index].c_str()
             : nullptr;
}

size_t tactus_stream_question_count(const tactus_stream* stream) {
  return stream == nullptr ? 0 : stream->info().questions.size();
}

const char* tactus_stream_question_name(const tactus_stream* stream,
                                        size_t question) {
  return question < tactus_stream_question_count(stream)
             ? stream->info().questions[question].name.c_str()
             : nullptr;
}

bool tactus_stream_question_is_state(const tactus_stream* stream,
                                     size_t question) {
  return question < tactus_stream_question_count(stream) &&
         stream->info().questions[question].is_state;
}

size_t tactus_stream_value_count(const tactus_stream* stream, size_t question) {
  const auto* const values = c::ValuesOf(stream, question);
  return values == nullptr ? 0 : values->size();
}

const char* tactus_stream_value_name(const tactus_stream* stream,
                                     size_t question, size_t value) {
  const auto* const values = c::ValuesOf(stream, question);
  return values == nullptr || value >= values->size()
             ? nullptr
             : (*values)[value].c_str();
}

const char* tactus_stream_model_sha256(const tactus_stream* stream) {
  return stream == nullptr ? nullptr : stream->info().model_sha256.c_str();
}

const tactus_answer* tactus_stream_answer(const tactus_stream* stream) {
  return stream == nullptr || !stream->has_answer ? nullptr
                                                  : c::ToC(&stream->answer);
}

bool tactus_stream_poll(tactus_stream* stream, tactus_event* event) {
  if (stream == nullptr || event == nullptr) return false;
  tactus::Event taken;
  if (!stream->stream->Poll(taken)) return false;
  c::WriteEvent(taken, stream->info(), event);
  return true;
}

bool tactus_stream_poll_notice(tactus_stream* stream, tactus_notice* notice) {
  if (stream == nullptr || notice == nullptr || stream->notices.empty()) {
    return false;
  }
  tactus_notice full = TACTUS_NOTICE_INIT;
  full.kind = static_cast<int32_t>(stream->notices.front().kind);
  c::CopyText(stream->notices.front().text, full.text);
  stream->notices.pop_front();
  c::CopyOut(full, notice);
  return true;
}
