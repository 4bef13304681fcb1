// A stream gets one notice that its model has a newer version, and keeps the
// version that it has.
#include "core/bundle/bundle.h"
#include "gtest/gtest.h"
#include "server/registry/model_registry.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/support/small_model.h"

namespace tactus::internal::server {
namespace {

class SupersededTest : public ::testing::Test {
 protected:
  SupersededTest() {
    Add("default", 1);
    Add("other", 1);
  }

  void Add(const std::string& name, uint64_t seed) {
    Model model = testing::SmallModel();
    model.provenance.seed = seed;
    ASSERT_TRUE(registry_.AddBuiltIn(name, *EncodeBundle(model)).ok());
  }

  void Start(StreamSession& session, const std::string& model) {
    auto config = testing::ConfigRequest();
    config.mutable_config()->set_model(model);
    ASSERT_TRUE(session.OnRequest(config).ok());
    session.responses().StartWrite(0);
    session.responses().FinishWrite();
  }

  // Sends one frame and returns how many notices come with its answer.
  static int Notices(StreamSession& session) {
    EXPECT_TRUE(session
                    .OnRequest(testing::DenseU16(session.frames() + 1,
                                                 {testing::Touch(1)}))
                    .ok());
    int notices = 0;
    int posteriors = 0;
    while (const auto* answer = session.responses().StartWrite(0)) {
      posteriors += answer->has_answer();
      if (answer->has_notice()) {
        EXPECT_EQ(answer->notice().kind(),
                  v1::StreamNotice::KIND_MODEL_SUPERSEDED);
        // The notice comes before the answer to the message.
        EXPECT_EQ(posteriors, 0);
        ++notices;
      }
      session.responses().FinishWrite();
    }
    EXPECT_EQ(posteriors, 1);
    return notices;
  }

  ModelRegistry registry_;
};

TEST_F(SupersededTest, ANewerVersionBringsOneNotice) {
  StreamSession session(&registry_, {});
  Start(session, "");
  EXPECT_EQ(Notices(session), 0);
  Add("default", 2);
  EXPECT_EQ(Notices(session), 1);
  EXPECT_EQ(Notices(session), 0);
  Add("default", 3);
  EXPECT_EQ(Notices(session), 0);
}

TEST_F(SupersededTest, EachStreamGetsNoticesOfItsModelOnly) {
  StreamSession by_name(&registry_, {});
  Start(by_name, "models/other");
  StreamSession by_version(&registry_, {});
  Start(by_version, "models/default/versions/1");
  Add("default", 2);
  EXPECT_EQ(Notices(by_name), 0);
  // This stream asked for the version that it has.
  EXPECT_EQ(Notices(by_version), 0);
  Add("other", 2);
  EXPECT_EQ(Notices(by_name), 1);
}

TEST_F(SupersededTest, AStreamThatStartsLaterHasTheNewVersion) {
  Add("default", 2);
  StreamSession session(&registry_, {});
  Start(session, "default");
  EXPECT_EQ(Notices(session), 0);
}

}  // namespace
}  // namespace tactus::internal::server
