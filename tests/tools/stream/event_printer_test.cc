#include "tools/stream/event_printer.h"

#include <string>

#include "gtest/gtest.h"
#include "tools/common/json.h"

namespace tactus::client {
namespace {

v1::StreamStarted Started() {
  v1::StreamStarted started;
  v1::Question& mobility = *started.add_questions();
  mobility.set_name("mobility");
  mobility.add_values("unmoved");
  mobility.add_values("moved\x1b");
  return started;
}

// What is printed of two events of a contact, 1.54 s after its onset.
std::string Printed(bool json) {
  v1::Answer answer;
  v1::Contact& contact = *answer.add_contacts();
  contact.set_id(2);
  contact.set_time_since_onset_ns(1'540'900'000);
  v1::ContactEvent& changed = *answer.add_events();
  changed.set_kind(v1::ContactEvent::KIND_CHANGED);
  changed.set_contact_id(2);
  changed.set_value(1);
  v1::ContactEvent& merged = *answer.add_events();
  merged.set_kind(v1::ContactEvent::KIND_MERGED);
  merged.set_contact_id(2);
  merged.set_other_id(7);
  EventPrinter printer(json);
  printer.OnStarted({}, Started());
  ::testing::internal::CaptureStdout();
  printer.OnAnswer(answer);
  return ::testing::internal::GetCapturedStdout();
}

// Names come from the server; control characters would reach the terminal.
TEST(EventPrinterTest, PrintsTheTextThatProgramsGet) {
  EXPECT_EQ(Printed(/*json=*/false),
            "1540 ms: contact 2 changed mobility: moved?\n"
            "1540 ms: contact 2 merged into contact 7\n");
}

TEST(EventPrinterTest, PrintsAnObjectALine) {
  const std::string lines = Printed(/*json=*/true);
  const size_t end = lines.find('\n');
  EXPECT_EQ(Json::parse(lines.substr(0, end))["event"], "CHANGED");
  EXPECT_EQ(
      Json::parse(lines.substr(end + 1)),
      Json({{"contact", 2}, {"ms", 1540}, {"event", "MERGED"}, {"other", 7}}));
}

TEST(EventJsonTest, HasWhatIsMeantAndNothingElse) {
  EXPECT_EQ(Json::parse(EventJson({.kind = EventKind::kDecided,
                                   .contact = 2,
                                   .since_onset_ns = 30'000'000,
                                   .question = "mobility",
                                   .value = "moved"})),
            Json({{"contact", 2},
                  {"ms", 30},
                  {"event", "DECIDED"},
                  {"question", "mobility"},
                  {"value", "moved"}}));
  EXPECT_EQ(
      Json::parse(EventJson({.kind = EventKind::kMovedOverSkin, .contact = 1})),
      Json({{"contact", 1}, {"ms", 0}, {"event", "MOVED_OVER_SKIN"}}));
}

}  // namespace
}  // namespace tactus::client
