// trainctl models list said "1970-01-01 00:00:00  0 B" of models that are part
// of the server, whose time and size a server does not state.
#include <cstdlib>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tactus/v1/models.pb.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(BuiltInModelsOf1970Test, ListHasNoTimeAndNoSize) {
  const ScratchDir folder;
  const std::string address = "unix:" + folder / "s";
  client::testing::FakeTrainingServer server(address);
  server.alter = [](google::protobuf::Message& message) {
    auto* response = dynamic_cast<v1::ListModelVersionsResponse*>(&message);
    if (response == nullptr) return;
    v1::ModelVersion& version = *response->add_versions();
    version.set_name("models/default/versions/1");
    version.set_built_in(true);
    version.add_class_names("HM");
    version.add_aliases("aliases/default");
  };
  const auto outcome =
      client::testing::Trainctl({"models", "list", "--server=" + address});
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "models/default/versions/1  built in  HM  <- aliases/default\n");
}

}  // namespace
}  // namespace tactus::internal
