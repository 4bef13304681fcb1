// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/base/address.h"
#include "core/base/aligned_vector.h"
#include "core/base/arguments.h"
#include "core/base/call_event.h"
#include "core/base/errors.h"
#include "core/base/gaussian.h"
#include "core/base/limits.h"
#include "core/base/mersenne_twister.h"
#include "core/base/random.h"
#include "core/base/serialize.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/thread_priority.h"
#include "core/base/wire_check.h"
#include "core/bundle/model_proto.h"
#include "core/classify/contact_pipeline.h"
#include "core/skin/frame.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"
#include "core/skin/layout_json.h"
#include "core/skin/taxel_grid.h"
#include "gtest/gtest.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::examples {

void AlignedVectorExample() { AlignedVector<float> cells(160); }

absl::StatusOr<Model> LoadModel(const std::string& path);

struct SomeStream {
  void Read(std::string* message, void* tag);
} stream;
std::string message;

class Call {
  void Start() { stream.Read(&message, read_done_.tag()); }
  void OnRead(bool ok);
  MemberEvent<Call> read_done_{this, &Call::OnRead};
};

void CallEventExample(void* tag, bool ok) {
  static_cast<CallEvent*>(tag)->OnEvent(ok);
}

absl::Status ErrorsExample(double rate) {
  return InvalidConfig("sample_rate_hz", rate, "above 0 and at most 10000");
}

void GaussianExample(Random& random) {
  std::vector<double> noise(1500);
  FillGaussian(random, noise);
}

void MersenneTwisterExample(uint64_t seed) {
  MersenneTwister engine(seed);
  const uint64_t one = engine();
  std::array<uint64_t, 100> many;
  engine.Fill(many);
}

void RandomExample(uint64_t seed) {
  Random random(seed);
  double noise = 0.002 * random.Gaussian();
}

void Sha256Example(const std::string& header, const std::string& payload) {
  Sha256 hash;
  hash.Add(header);
  hash.Add(payload);
  const std::string digest = hash.Finish();  // 32 bytes
}

absl::Status StatusMacrosExample(const SkinLayout& layout,
                                 const std::string& path) {
  TACTUS_RETURN_IF_ERROR(Validate(layout));
  TACTUS_ASSIGN_OR_RETURN(Model model, LoadModel(path));
  return absl::OkStatus();
}

void SerializeExample(const Model& model, const v1::ModelBundle& bundle) {
  const std::string payload = SerializeDeterministic(bundle);
  EXPECT_EQ(payload, SerializeDeterministic(ModelToProto(model)));
}

void ArgumentsExample(int argc, char** argv) {
  const absl::Status status = CheckArguments(argc, argv);
}

absl::Status TextExample(const std::string& label) {
  const auto complain = [](const std::string& name, const std::string& fault) {
    return InvalidTrainingData(name + " " + fault);
  };
  const std::string fault = TextFault(label, limits::kMaxTrialTextBytes);
  if (!fault.empty()) return complain("label", fault);
  return absl::OkStatus();
}

void FrameExample(std::span<const float> taxels, const Pose& pose,
                  ContactPipeline* pipeline) {
  FrameView frame{.taxels = taxels, .pose = &pose};
  pipeline->Step(frame);
}

absl::Status LayoutJsonExample(const SkinLayout& layout) {
  const std::string text = LayoutToJson(layout);
  TACTUS_ASSIGN_OR_RETURN(SkinLayout again, LayoutFromJson(text));
  return absl::OkStatus();
}

absl::Status TaxelGridExample(const std::vector<Eigen::Vector3d>& positions,
                              std::vector<float>& frame, size_t i,
                              float value_of_taxel_i) {
  TACTUS_ASSIGN_OR_RETURN(const TaxelGrid grid, PlaceOnGrid(positions));
  frame[grid.cells[i]] = value_of_taxel_i;
  return absl::OkStatus();
}

void GeometryExample(const SkinLayout& layout) {
  const Eigen::Vector3d position = LinkPosition(layout, {.row = 3.5});
}

absl::Status LayoutExample() {
  TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, LayoutPreset("cody-forearm"));
  return absl::OkStatus();
}

absl::Status AddressExample(const std::string& address) {
  std::string path;
  if (IsUnixAddress(address)) path = UnixPath(address);
  TACTUS_ASSIGN_OR_RETURN(const HostPort at, ParseHostPort("[::1]:50051"));
  return absl::OkStatus();
}

absl::Status WireCheckExample(const std::string& bytes, int64_t limit) {
  const WireCheck check = CheckWire(*v1::TrialRecord::descriptor(), bytes);
  if (!check.fault.empty()) return InvalidTrial(check.fault);
  if (check.parsed_bytes > limit) return InvalidTrial("it is too large");
  return absl::OkStatus();
}

void ThreadPriorityExample() {
  SetThreadPriority(ThreadPriority::kPrompt);
  SetThreadPriority(ThreadPriority::kBackground);
}

}  // namespace tactus::examples
