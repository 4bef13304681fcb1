// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <memory>

#include "client/drivers/recording_driver.h"
#include "client/recording/posterior_check.h"
#include "client/recording/recorder.h"
#include "client/stream/contact_stream.h"
#include "core/base/status_macros.h"

namespace tactus::client::examples {

void Use(const SkinFrame& frame);
void Expect(const v1::Posterior& posterior);

void LabelledDriverExample(LabelledDriver& driver, SkinFrame& frame) {
  while (*driver.Read(frame) == ReadResult::kFrame) Use(frame);
  driver.trial().label;  // "HU"
}

absl::Status RecordingDriverExample() {
  RecordingDriver driver(
      "run.mcap", {.on_event = [&](const auto& event) {
        if (const auto* p = std::get_if<v1::Posterior>(&event)) Expect(*p);
      }});
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
  return absl::OkStatus();
}

absl::Status RecorderExample(const SkinInfo& info,
                             const v1::StreamConfig& config,
                             const std::unique_ptr<ContactStream>& stream,
                             const SkinFrame& frame,
                             const v1::Posterior& posterior) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto recorder,
      Recorder::Create("run.mcap", {.about = {{"driver", "sim"}}}));
  recorder->Begin(info, config, stream->started());
  recorder->BeginTrial({{"label", "HU"}});
  recorder->Frame(frame);  // as the driver returned it
  recorder->Result(posterior);
  recorder->EndTrial();
  TACTUS_RETURN_IF_ERROR(recorder->Finish());
  return absl::OkStatus();
}

void PosteriorCheckExample(const v1::Posterior& recorded,
                           const v1::Posterior& posterior) {
  PosteriorCheck check;
  check.Expect(recorded);
  check.Receive(posterior);
  check.Result().equal;  // 1
}

}  // namespace tactus::client::examples
