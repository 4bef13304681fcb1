#include "core/base/status_proto.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(StatusProtoTest, EverythingComesBack) {
  for (const absl::Status& status :
       {absl::OkStatus(), IoError("/a", "b"), InvalidName("x", "y"),
        StorageFull("/disk", "no room"), absl::InternalError("plain"),
        absl::CancelledError("")}) {
    v1::Status message;
    ASSERT_TRUE(
        message.ParseFromString(ToStatusProto(status).SerializeAsString()));
    const absl::Status same = FromStatusProto(message);
    EXPECT_EQ(same, status);
    EXPECT_EQ(ReasonOf(same), ReasonOf(status));
  }
}

// From another process: a code that this program does not know is no success.
TEST(StatusProtoTest, AnUnknownCodeIsAnError) {
  v1::Status message;
  message.set_code(999);
  message.set_message("from the future");
  EXPECT_FALSE(FromStatusProto(message).ok());
}

}  // namespace
}  // namespace tactus::internal
