// A Stream in this process allocates nothing per frame. Apart from the tests of
// servers: gRPC's library and a counting operator new do not go together under
// AddressSanitizer.
#include "client/front/local_stream.h"
#include "gtest/gtest.h"
#include "tests/client/front/front_frames.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/small_model.h"

namespace tactus::internal::client {
namespace {

using testing::CodyFrame;
using testing::CodySkin;
using testing::Touch;

LocalModel SmallLocalModel() {
  return {.model = *CompiledModel::Create(testing::SmallModel()),
          .version = "small",
          .sha256 = ""};
}

TEST(ClassifierTest, AFrameAllocatesNothing) {
  Answer kept;
  auto stream = *OpenLocalStream(
      SmallLocalModel(), CodySkin(),
      {.on_answer =
           [&](const Answer& answer) { kept.sequence += answer.sequence; },
       .on_event = [](const Event&) {}});
  uint64_t sequence = 0;
  Frame frame = CodyFrame(1, Touch(2));
  const auto push = [&] {
    frame.capture_time_ns += 10'000'000;
    ++sequence;
    ASSERT_TRUE(stream->Push(frame).ok());
  };
  for (int i = 0; i < 50; ++i) push();
  const testing::AllocationCounter counter;
  for (int i = 0; i < 50; ++i) push();
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus::internal::client
