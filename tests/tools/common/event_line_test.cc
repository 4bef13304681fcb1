#include "tools/common/event_line.h"

#include "gtest/gtest.h"
#include "tools/common/json.h"

namespace tactus::internal::client {
namespace {

using v1::ContactEvent;

v1::StreamStarted Started() {
  v1::StreamStarted started;
  v1::Question& hardness = *started.add_questions();
  hardness.set_name("hardness");
  hardness.add_values("hard");
  hardness.add_values("soft");
  v1::Question& mobility = *started.add_questions();
  mobility.set_name("mobility");
  mobility.add_values("unmoved");
  mobility.add_values("moved");
  return started;
}

ContactEvent Event(ContactEvent::Kind kind, int question = 0, int value = 0) {
  ContactEvent event;
  event.set_kind(kind);
  event.set_contact_id(2);
  event.set_question(question);
  event.set_value(value);
  event.set_other_id(7);
  return event;
}

TEST(EventLineTest, SaysWhatHappenedAndWhen) {
  struct Case {
    ContactEvent event;
    int64_t ms;
    const char* line;
  };
  for (const Case& c : {
           Case{Event(ContactEvent::KIND_TOUCHED), 0,
                "contact 2  0 ms: touched"},
           Case{Event(ContactEvent::KIND_DECIDED, 0, 0), 120,
                "contact 2  120 ms: hard"},
           Case{Event(ContactEvent::KIND_CHANGED, 1, 1), 1540,
                "contact 2  1,540 ms: now slipping"},
           Case{Event(ContactEvent::KIND_SPLIT), 1'234'567,
                "contact 2  1,234,567 ms: parted from contact 7"},
       }) {
    EXPECT_EQ(EventLine(c.event, c.ms, Started(), /*json=*/false), c.line);
  }
}

TEST(EventLineTest, JsonHasWhatIsMeantAndNothingElse) {
  const auto line = [](const ContactEvent& event) {
    return Json::parse(EventLine(event, 30, Started(), /*json=*/true));
  };
  EXPECT_EQ(line(Event(ContactEvent::KIND_DECIDED, 1, 1)),
            Json({{"contact", 2},
                  {"ms", 30},
                  {"event", "DECIDED"},
                  {"question", "mobility"},
                  {"value", "moved"}}));
  EXPECT_EQ(
      line(Event(ContactEvent::KIND_MERGED)),
      Json({{"contact", 2}, {"ms", 30}, {"event", "MERGED"}, {"other", 7}}));
  EXPECT_EQ(line(Event(ContactEvent::KIND_RELEASED)),
            Json({{"contact", 2}, {"ms", 30}, {"event", "RELEASED"}}));
}

}  // namespace
}  // namespace tactus::internal::client
