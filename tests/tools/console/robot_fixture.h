// File: robot_fixture.h
//
// Updates of made-up robots, as a server sends them. Test-only.
//
//   news.Add(OpenedRobot("7", "arm"), now);
//   news.Add(FrameOf("7", /*sequence=*/1), now);
#pragma once

#include <string>
#include <vector>

#include "core/skin/layout_proto.h"
#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::console {

// A robot with a skin of 2 x 3 taxels and one question, hard or soft.
inline v1::StreamUpdate OpenedRobot(const std::string& stream,
                                    const std::string& name) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.rows = 2;
  layout.columns = 3;
  v1::StreamUpdate update;
  update.set_stream_id(stream);
  v1::OpenStream& opened = *update.mutable_opened();
  opened.set_stream_id(stream);
  opened.set_client_id(name);
  *opened.mutable_started()->mutable_geometry() = LayoutToProto(layout);
  v1::Question& question = *opened.mutable_started()->add_questions();
  question.add_values("hard");
  question.add_values("soft");
  return update;
}

// A frame in which contact 1 presses on taxel 4, which reads the sequence
// number.
inline v1::StreamUpdate FrameOf(const std::string& stream, uint64_t sequence) {
  v1::StreamUpdate update;
  update.set_stream_id(stream);
  v1::WatchedFrame& frame = *update.mutable_frame();
  std::vector<float> taxels(6);
  taxels[4] = static_cast<float>(sequence);
  frame.set_taxels(taxels.data(), taxels.size() * sizeof(float));
  v1::Answer& answer = *frame.mutable_answer();
  answer.set_sequence(sequence);
  answer.set_capture_time_ns(static_cast<int64_t>(sequence) * 10'000'000);
  v1::Contact& contact = *answer.add_contacts();
  contact.set_id(1);
  contact.mutable_patch()->add_taxels(4);
  contact.add_answers()->mutable_decision()->set_value(1);
  return update;
}

inline v1::StreamUpdate EventOf(const std::string& stream, uint64_t sequence) {
  v1::StreamUpdate update;
  update.set_stream_id(stream);
  update.add_events()->set_sequence(sequence);
  return update;
}

inline v1::StreamUpdate EndOf(const std::string& stream) {
  v1::StreamUpdate update;
  update.set_stream_id(stream);
  update.set_ended(true);
  return update;
}

}  // namespace tactus::internal::console
