#include "server/contact_log/contact_name.h"

#include <limits>

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

TEST(ContactNameTest, ComesBackAsItWas) {
  constexpr uint64_t kRecords[] = {
      1, 2, 9, 10, 17, 4'294'967'296, std::numeric_limits<uint64_t>::max()};
  constexpr uint32_t kPlaces[] = {
      0, 1, 2, 8, 9, 98, std::numeric_limits<uint32_t>::max() - 1};
  for (const uint64_t record : kRecords) {
    for (const uint32_t place : kPlaces) {
      const ContactName name{record, place};
      const auto parsed = ParseContactName(name.ToString());
      ASSERT_TRUE(parsed.ok()) << parsed.status();
      EXPECT_EQ(*parsed, name) << name.ToString();
    }
  }
  EXPECT_EQ((ContactName{17, 0}).ToString(), "contacts/17");
  EXPECT_EQ((ContactName{17, 1}).ToString(), "contacts/17-2");
}

TEST(ContactNameTest, StandInTheOrderOfRecordAndPlace) {
  EXPECT_LT((ContactName{1, 5}), (ContactName{2, 0}));
  EXPECT_LT((ContactName{2, 0}), (ContactName{2, 1}));
  // Not in that of their text.
  EXPECT_LT((ContactName{9, 0}), (ContactName{10, 0}));
}

TEST(ContactNameTest, EachContactHasOneName) {
  const std::string names[] = {
      "",
      "contacts",
      "contacts/",
      "contacts//1",
      "contacts/-",
      "contacts/-1",
      "contacts/-2",
      "contacts/0x1",
      "contacts/1x",
      "contacts/x",
      "contacts/1-",
      "contacts/1-0",
      "contacts/1-1",
      "contacts/1-02",
      "contacts/1-+2",
      "contacts/1--2",
      "contacts/1-2-3",
      "contacts/1-2 ",
      "contacts/1- 2",
      "contacts/1/2",
      "contacts/01",
      "contacts/00",
      "contacts/+1",
      "contacts/ 1",
      "contacts/1 ",
      " contacts/1",
      "contacts/1\n",
      "contacts/1.0",
      "contacts/1e3",
      "contacts/1,000",
      "contacts/18446744073709551616",
      "contacts/99999999999999999999999999999999999999",
      "contacts/1-4294967296",
      "contacts/1-18446744073709551618",
      "Contacts/1",
      "contact/1",
      "models/1",
      "/contacts/1",
      "xcontacts/1",
      "1",
      std::string("contacts/1\0", 11),
      std::string("contacts/\0001", 11),
      std::string(100'000, '1'),
      "contacts/" + std::string(100'000, '0') + "1",
  };
  for (const std::string& name : names) {
    const auto parsed = ParseContactName(name);
    ASSERT_FALSE(parsed.ok()) << name;
    EXPECT_EQ(ReasonOf(parsed.status()), "INVALID_NAME") << name;
    EXPECT_LT(parsed.status().message().size(), 1000u);
  }
}

}  // namespace
}  // namespace tactus::internal::server
