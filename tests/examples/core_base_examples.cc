// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
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
#include "core/base/text_cells.h"
#include "core/base/text_lines.h"
#include "core/base/thread_priority.h"
#include "core/base/wilson_interval.h"
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

namespace tactus::internal::examples {

absl::StatusOr<Model> LoadModel(const std::string& path);

static void AlignedVectorExample() {
#include "core/base/aligned_vector.h.inc"
}

struct SomeStream {
  void Read(std::string* message, void* tag);
} stream;
std::string message;

#include "core/base/call_event.h.inc"

static absl::Status ErrorsExample(double rate) {
#include "core/base/errors.h.inc"
}

static void GaussianExample(Random& random) {
#include "core/base/gaussian.h.inc"
}

static void MersenneTwisterExample(uint64_t seed) {
#include "core/base/mersenne_twister.h.inc"
}

static void RandomExample(uint64_t seed) {
#include "core/base/random.h.inc"
}

static void Sha256Example(const std::string& header,
                          const std::string& payload) {
#include "core/base/sha256.h.inc"
}

static absl::Status StatusMacrosExample(const SkinLayout& layout,
                                        const std::string& path) {
#include "core/base/status_macros.h.inc"
  return absl::OkStatus();
}

static void SerializeExample(const Model& model,
                             const v1::ModelBundle& bundle) {
#include "core/base/serialize.h.inc"
}

static void ArgumentsExample(int argc, char** argv) {
#include "core/base/arguments.h.inc"
}

static absl::Status TextExample(const std::string& label) {
  const auto complain = [](const std::string& name, const std::string& fault) {
    return InvalidTrainingData(name + " " + fault);
  };
#include "core/base/text.h.inc"
  return absl::OkStatus();
}

static void FrameExample(std::span<const float> taxels, const Pose& pose,
                         ContactPipeline* pipeline) {
#include "core/skin/frame.h.inc"
}

static absl::Status LayoutJsonExample(const SkinLayout& layout) {
#include "core/skin/layout_json.h.inc"
  return absl::OkStatus();
}

static absl::Status TaxelGridExample(
    const std::vector<Eigen::Vector3d>& positions, std::vector<float>& frame,
    size_t i, float value_of_taxel_i) {
#include "core/skin/taxel_grid.h.inc"
  return absl::OkStatus();
}

static void GeometryExample(const SkinLayout& layout) {
#include "core/skin/geometry.h.inc"
}

static absl::Status LayoutExample() {
#include "core/skin/layout.h.inc"
  return absl::OkStatus();
}

static absl::Status AddressExample(const std::string& address) {
  std::string path;
#include "core/base/address.h.inc"
  return absl::OkStatus();
}

static absl::Status WireCheckExample(const std::string& bytes, int64_t limit) {
#include "core/base/wire_check.h.inc"
  return absl::OkStatus();
}

void Use(size_t number, absl::string_view line);

static void TextLinesExample(const std::string& text) {
#include "core/base/text_lines.h.inc"
}

static void TextCellsExample() {
#include "core/base/text_cells.h.inc"
}

static void WilsonIntervalExample() {
#include "core/base/wilson_interval.h.inc"
}

static void ThreadPriorityExample() {
#include "core/base/thread_priority.h.inc"
}

}  // namespace tactus::internal::examples
