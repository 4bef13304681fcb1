#include "tools/console/robot_channels.h"

#include <cstring>

#include "absl/strings/ascii.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/data/recording/message_schema.h"
#include "core/skin/layout_proto.h"

namespace tactus::internal::console {
namespace {

std::string SkinOf(const RobotView& robot, const v1::WatchedFrame& frame) {
  std::vector<float> values(static_cast<size_t>(robot.layout.values()));
  // A server may show a frame without its taxels.
  if (frame.taxels().size() != values.size() * sizeof(float)) return "";
  std::memcpy(values.data(), frame.taxels().data(), frame.taxels().size());
  return robot.image.EncodeFloats(frame.answer().capture_time_ns(), values);
}

std::string AnswerOf(const RobotView&, const v1::WatchedFrame& frame) {
  return SerializeDeterministic(frame.answer());
}

std::string ContactsOf(const RobotView& robot, const v1::WatchedFrame& frame) {
  return robot.contacts.Encode(frame.answer());
}

}  // namespace

absl::StatusOr<RobotView> RobotView::Of(const v1::OpenStream& opened) {
  TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout,
                          LayoutFromProto(opened.started().geometry()));
  return RobotView{
      .layout = layout,
      .image = FoxgloveImage(layout),
      .contacts = FoxgloveContacts(layout, opened.started().questions())};
}

const std::vector<RobotChannel>& RobotChannels() {
  static const auto* channels = new std::vector<RobotChannel>{
      {"skin", FoxgloveImage::Schema(), SkinOf},
      {"answer", MessageSchema(*v1::Answer::descriptor()), AnswerOf},
      {"contacts", FoxgloveContacts::Schema(), ContactsOf},
      {"events", MessageSchema(*v1::WatchedEvent::descriptor())}};
  return *channels;
}

std::string TopicPart(absl::string_view name) {
  std::string part(name);
  for (char& c : part) {
    if (!absl::ascii_isalnum(static_cast<unsigned char>(c)) && c != '-') {
      c = '_';
    }
  }
  return part;
}

}  // namespace tactus::internal::console
