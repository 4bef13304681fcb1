// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "client/c/include/tactus.h"
#include "client/c/structs.h"
#include "client/drivers/sim_driver.h"
#include "client/front/answer_delivery.h"
#include "client/front/local_stream.h"
#include "client/front/plugin_driver.h"
#include "client/front/remote_stream.h"
#include "client/front/skin_convert.h"
#include "client/front/wrapped_driver.h"
#include "client/python/native/local_fit.h"
#include "client/python/native/local_session.h"
#include "core/base/status_macros.h"
#include "tactus/classifier.h"
#include "tactus/client.h"
#include "tactus/driver.h"
#include "tactus/mock.h"
#include "tactus/status.h"

namespace tactus::internal::examples {

void ChooseAnotherModel();
void LetGo();
void ReadSkin(Frame& frame);
void Use(double probability);
void Use(const std::string& text);
void Use(const Event& event);

static void StatusExample(const Client& client) {
#include "client/include/tactus/status.h.inc"
}

static void SkinExample() {
#include "client/include/tactus/skin.h.inc"
}

static void AnswerExample(const Answer& answer) {
#include "client/include/tactus/answer.h.inc"
}

static absl::Status StreamExample(Stream& stream, Frame& frame) {
#include "client/include/tactus/stream.h.inc"
}

static absl::Status ClientExample(const Frame& frame) {
#include "client/include/tactus/client.h.inc"
}

static absl::Status ClassifierExample(const Frame& frame) {
#include "client/include/tactus/classifier.h.inc"
}

static absl::Status LocalSessionExample(const std::string& config,
                                        const std::string& request) {
  using python::LocalModel;
  using python::LocalSession;
#include "client/python/native/local_session.h.inc"
  return absl::OkStatus();
}

static absl::Status LocalFitExample(
    const std::string& spec, const std::vector<python::BorrowedTrial>& trials) {
  using python::LocalFit;
#include "client/python/native/local_fit.h.inc"
  return absl::OkStatus();
}

static void CInterfaceExample(const float* values) {
#include "client/c/include/tactus.h.inc"
}

static absl::Status CStructsExample(const tactus_skin* given,
                                    const tactus_event& full,
                                    tactus_event* event,
                                    const absl::Status& status,
                                    tactus_error* error) {
  using c::CopyOut;
  using c::CopyText;
  using c::SkinFromC;
#include "client/c/structs.h.inc"
  return absl::OkStatus();
}

static void MockExample(const Frame& frame) {
#include "client/include/tactus/mock.h.inc"
}

#include "client/include/tactus/driver.h.inc"

}  // namespace tactus::internal::examples

namespace tactus::internal::client::examples {

void Use(const Answer& answer);
void Use(const Event& event);

static void AnswerConverterExample(const v1::StreamStarted& started,
                                   const v1::Answer& answer) {
#include "client/front/answer_convert.h.inc"
}

static void AnswerDeliveryExample(const StreamOptions& options,
                                  const v1::StreamStarted& started,
                                  const v1::ClassifyContactResponse& response,
                                  Event& event) {
#include "client/front/answer_delivery.h.inc"
}

static void EventQueueExample(const Event& event) {
#include "client/front/event_queue.h.inc"
}

static absl::Status LocalStreamExample(const LocalModel& model,
                                       const Skin& skin,
                                       const StreamOptions& options,
                                       const Frame& frame) {
#include "client/front/local_stream.h.inc"
}

static absl::Status PluginDriverExample(const DriverOptions& options) {
#include "client/front/plugin_driver.h.inc"
  return absl::OkStatus();
}

static absl::Status RemoteStreamExample(
    const std::shared_ptr<grpc::Channel>& channel, const Skin& skin,
    const StreamOptions& options, const std::string& token,
    const Frame& frame) {
#include "client/front/remote_stream.h.inc"
}

static absl::Status SkinConvertExample(const Skin& skin, const Frame& frame) {
#include "client/front/skin_convert.h.inc"
  return absl::OkStatus();
}

struct MyDriver : SkinDriver {
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override;
};

static void WrappedDriverExample(std::unique_ptr<Driver> driver) {
#include "client/front/wrapped_driver.h.inc"
}

}  // namespace tactus::internal::client::examples
