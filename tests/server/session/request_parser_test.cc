// Compares the parser that reuses its memory with the parser of protobuf.
#include "server/session/request_parser.h"

#include <string>
#include <vector>

#include "core/base/random.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::server {
namespace {

using google::protobuf::io::ArrayInputStream;
using testing::DenseU16;
using testing::SparseU16;
using testing::Touch;

bool Parse(const std::string& bytes, v1::ClassifyContactRequest* request,
           int block_size = -1) {
  ArrayInputStream stream(bytes.data(), static_cast<int>(bytes.size()),
                          block_size);
  return ParseRequest(&stream, request);
}

// Messages of every kind, good, odd and broken.
std::vector<std::string> Samples() {
  auto with_pose = DenseU16(3, {Touch(1)});
  testing::AddPose({}, with_pose.mutable_frames());
  const std::string config = testing::ConfigRequest().SerializeAsString();
  const std::string dense = DenseU16(1, {Touch(1)}).SerializeAsString();
  const std::string sparse = SparseU16(2, {Touch(2)}).SerializeAsString();
  // Field 100 of the message, and of its frames.
  const std::string unknown = "\xa0\x06\x01";
  const std::string unknown_within = std::string("\x12\x03") + unknown;
  return {config, dense, sparse, with_pose.SerializeAsString(),
          testing::EndOfTrialRequest().SerializeAsString(), "", unknown,
          unknown + dense, dense + unknown, unknown_within,
          std::string("\x12\x00", 2),
          // Sparse frames that are empty, that hold only what is unknown, and
          // twice.
          std::string("\x12\x02\x2a\x00", 4),
          std::string("\x12\x05\x2a\x03") + unknown, sparse + sparse,
          dense + sparse, dense + config, config + dense,
          dense.substr(0, dense.size() / 2), "\xff\xff\xff", "\x12", "\x14"};
}

TEST(RequestParserTest, GivesWhatProtobufGivesWhateverCameBefore) {
  const std::vector<std::string> samples = Samples();
  Random random(1);
  v1::ClassifyContactRequest request;
  for (int i = 0; i < 5000; ++i) {
    const std::string& bytes = samples[random.Index(samples.size())];
    v1::ClassifyContactRequest want;
    const bool ok = want.ParseFromString(bytes);
    const int block_size = random.Index(2) == 0 ? -1 : 1;
    ASSERT_EQ(Parse(bytes, &request, block_size), ok);
    if (!ok) continue;
    ASSERT_EQ(request.request_case(), want.request_case());
    ASSERT_EQ(request.SerializeAsString(), want.SerializeAsString());
  }
}

TEST(RequestParserTest, FramesAfterFramesAllocateNothing) {
  for (auto message :
       {DenseU16(1, {Touch(1)}), testing::DenseF32(1, {Touch(1)}),
        SparseU16(1, {Touch(1)}), testing::SparseF32(1, {Touch(1)})}) {
    testing::AddPose({}, message.mutable_frames());
    const std::string bytes = message.SerializeAsString();
    v1::ClassifyContactRequest request;
    ASSERT_TRUE(Parse(bytes, &request));
    const testing::AllocationCounter counter;
    for (int i = 0; i < 100; ++i) Parse(bytes, &request);
    EXPECT_EQ(counter.count(), 0);
  }
}

}  // namespace
}  // namespace tactus::internal::server
