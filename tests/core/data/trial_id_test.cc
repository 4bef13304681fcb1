#include "core/data/trial_id.h"

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(TrialIdTest, OneRule) {
  const std::string longest(64, 'a');
  for (const std::string& id : {std::string("000000"), std::string("A-b_9"),
                                std::string("-"), longest}) {
    EXPECT_EQ(TrialIdFault(id), "");
    EXPECT_EQ(SafeTrialId(id), id);
  }
  for (const std::string& id :
       {std::string(), std::string("touch 1"), std::string("a/b"),
        std::string(".."), std::string("r\xC3\xA4"), std::string("a\nb"),
        longest + "a"}) {
    EXPECT_NE(TrialIdFault(id), "") << id;
    EXPECT_EQ(TrialIdFault(SafeTrialId(id)), "") << id;
  }
  EXPECT_EQ(SafeTrialId("touch 1"), "touch_1");
}

TEST(TrialIdTest, EachIsHandedOutOnce) {
  TrialIds ids;
  ids.Add("b");
  const std::string longest(64, 'a');
  EXPECT_EQ(ids.Unique("a"), "a");
  EXPECT_EQ(ids.Unique("a"), "a-2");
  EXPECT_EQ(ids.Unique("a-2"), "a-2-2");
  EXPECT_EQ(ids.Unique("a"), "a-3");
  EXPECT_EQ(ids.Unique("b"), "b-2");
  EXPECT_EQ(ids.Unique(longest), longest);
  EXPECT_EQ(ids.Unique(longest), std::string(62, 'a') + "-2");
  EXPECT_EQ(ids.Unique(""), "trial");
}

}  // namespace
}  // namespace tactus::internal
