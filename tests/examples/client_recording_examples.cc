// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <memory>

#include "client/drivers/recording_driver.h"
#include "client/recording/answer_check.h"
#include "client/recording/recorder.h"
#include "client/stream/contact_stream.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client::examples {

void Use(const SkinFrame& frame);
void Expect(const v1::Answer& answer);

static void LabelledDriverExample(LabelledDriver& driver, SkinFrame& frame) {
#include "client/drivers/labelled_driver.h.inc"
}

static absl::Status RecordingDriverExample() {
#include "client/drivers/recording_driver.h.inc"
  return absl::OkStatus();
}

static absl::Status RecorderExample(
    const SkinInfo& info, const v1::StreamConfig& config,
    const std::unique_ptr<ContactStream>& stream, const SkinFrame& frame,
    const v1::Answer& answer) {
#include "client/recording/recorder.h.inc"
  return absl::OkStatus();
}

static void AnswerCheckExample(const v1::Answer& recorded,
                               const v1::Answer& answer) {
#include "client/recording/answer_check.h.inc"
}

}  // namespace tactus::internal::client::examples
