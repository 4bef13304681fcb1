// Damages models of other programs: HMMs as JSON (hmmlearn's names and GHMM's)
// and .npz, LSTMs as ONNX. What is read goes into a model, which must then be
// one that can be served.
#include "core/bundle/bundle.h"
#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "core/interchange/lstm/lstm_from_onnx.h"
#include "core/interchange/replace_models.h"
#include "tests/fuzz/damaged.h"
#include "tests/support/small_model.h"

namespace {

using namespace tactus::internal;

void Use(const absl::StatusOr<ForeignModel>& foreign) {
  fuzz::RequireReason(foreign.status());
  if (!foreign.ok()) return;
  Model model = testing::SmallModel();
  const absl::Status status = ReplaceModels(*foreign, model);
  fuzz::RequireReason(status);
  if (status.ok()) REQUIRE(EncodeBundle(model).ok());
}

// The good files are good.
void RequireAll(const std::vector<std::string>& files,
                absl::StatusOr<ForeignModel> (*parse)(absl::string_view,
                                                      absl::string_view)) {
  for (const std::string& file : files) REQUIRE(parse("good", file).ok());
}

std::vector<std::string> OnnxFiles() {
  std::vector<std::string> files;
  for (const char* name :
       {"tanh-sigmoid-step", "tanh-sigmoid-sequence", "mean-of-three-step",
        "torch-1-time-first-opset13", "torch-2-last-batch-first-opset13",
        "torch-3-last-time-first-opset9"}) {
    files.push_back(fuzz::Golden("interchange/" + std::string(name) + ".onnx"));
  }
  return files;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const json = new std::vector<std::string>{
      HmmsToJson(testing::SmallModel(), HmmJsonStyle::kHmmlearn),
      HmmsToJson(testing::SmallModel(), HmmJsonStyle::kGhmm)};
  static const auto* const npz =
      new std::vector<std::string>{*HmmsToNpz(testing::SmallModel())};
  static const auto* const onnx = new std::vector<std::string>(OnnxFiles());
  if (size == 0) {
    RequireAll(*json, HmmsFromJson);
    RequireAll(*npz, HmmsFromNpz);
    RequireAll(*onnx, LstmsFromOnnx);
  }
  FuzzedDataProvider data(bytes, size);
  switch (data.ConsumeIntegralInRange(0, 2)) {
    case 0:
      Use(HmmsFromJson("x.json", fuzz::Damaged(*json, data)));
      break;
    case 1:
      Use(HmmsFromNpz("x.npz", fuzz::Damaged(*npz, data)));
      break;
    default:
      Use(LstmsFromOnnx("x.onnx", fuzz::Damaged(*onnx, data)));
  }
  return 0;
}
