// `trainctl classify` never ended a contact before the end of its trial, a
// server ended it after 0.5 s without touch. Where touch was lost for longer
// and came back, the server's final answer was about the second contact alone:
// 8 of 144 finals differed. Both now take the time from the bundle.
#include <cstring>

#include "core/base/random.h"
#include "core/bundle/bundle.h"
#include "core/data/trial_file.h"
#include "core/files/draft_file.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "server/session/stream_session.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_model.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using testing::RunTrainctl;

class OneModel : public server::ModelSource {
 public:
  explicit OneModel(const Model& model)
      : model_(*CompiledModel::Create(model)) {}
  absl::StatusOr<server::PinnedModel> Find(absl::string_view,
                                           absl::string_view) const override {
    return server::PinnedModel{model_, "models/a/versions/1",
                               std::string(64, 'a')};
  }

 private:
  std::shared_ptr<const CompiledModel> model_;
};

// Two presses of different strength; between them touch is lost for 0.2 to 1 s.
Trial TwoPresses(int number) {
  Random random(number);
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  Trial trial;
  trial.id = absl::StrCat("00000", number);
  trial.label = "HU";
  SetSkin(layout, trial);
  trial.taxels.rows = layout.rows;
  trial.taxels.columns = layout.columns;
  const int lost_from = 60;
  const int lost_until = 80 + 10 * number;
  for (int t = 0; t < 220; ++t) {
    trial.time.push_back(0.01 * t);
    const bool touched = t >= 10 && (t < lost_from || t >= lost_until);
    const double force = t < lost_from ? 3 : 0.2;
    for (int i = 0; i < layout.taxels(); ++i) {
      const bool here = touched && i >= 100 && i < 103;
      trial.taxels.f32.push_back(
          here ? static_cast<float>(force + 0.1 * random.Uniform()) : 0.F);
    }
  }
  return trial;
}

// The final answer of a stream that leaves the release to the model.
std::vector<double> ServersFinal(const OneModel& models, const Trial& trial) {
  server::StreamSession session(&models, {.stream_id = "1"});
  v1::ClassifyContactRequest request;
  request.mutable_config()->mutable_geometry()->set_layout(trial.layout);
  request.mutable_config()->set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
  EXPECT_TRUE(session.OnRequest(request).ok());
  for (size_t t = 0; t < trial.time.size(); ++t) {
    v1::FrameBatch* batch = request.mutable_frames();
    batch->set_first_sequence(t + 1);
    batch->set_first_capture_time_ns(static_cast<int64_t>(t) * 10'000'000);
    batch->set_frame_count(1);
    std::string bytes(384 * sizeof(float), '\0');
    std::memcpy(bytes.data(), &trial.taxels.f32[t * 384], bytes.size());
    batch->set_taxels(bytes);
    EXPECT_TRUE(session.OnRequest(request).ok());
  }
  request.mutable_end_of_trial();
  EXPECT_TRUE(session.OnRequest(request).ok());
  std::vector<double> final;
  while (const auto* response = session.responses().StartWrite(0)) {
    if (response->has_answer() && response->answer().is_final()) {
      const auto& probability = response->answer().contacts(0).probability();
      final.assign(probability.begin(), probability.end());
    }
    session.responses().FinishWrite();
  }
  return final;
}

TEST(FinalsOfClassifyAndServerTest, AreEqualWhateverTheBundleSays) {
  constexpr int kTrials = 9;
  const ScratchDir folder;
  const std::string data = folder / "finals.h5";
  const std::string bundle = folder / "finals.tactus";
  {
    auto writer = *TrialFileWriter::Create(data, {.overwrite = true});
    for (int i = 0; i < kTrials; ++i) {
      ASSERT_TRUE(writer.Append(TwoPresses(i)).ok());
    }
    ASSERT_TRUE(writer.Close().ok());
  }
  std::vector<std::vector<double>> finals[2];
  for (const double release_after_s : {0.5, -1.0}) {
    Model model = testing::SmallModel();
    model.release_after_s = release_after_s;
    ASSERT_TRUE(WriteFileBytes(bundle, *EncodeBundle(model)).ok());
    const auto run =
        RunTrainctl("classify --json --data=" + data + " --model=" + bundle);
    ASSERT_TRUE(run.status.ok()) << run.status;
    const auto answers = client::Json::parse(run.out)["trials"];
    const OneModel models(model);
    for (int i = 0; i < kTrials; ++i) {
      const std::vector<double> answer = answers[i]["probability"];
      EXPECT_EQ(answer, ServersFinal(models, TwoPresses(i))) << i;
      finals[release_after_s < 0].push_back(answer);
    }
  }
  // A loss of 0.2 s ends no contact, longer ones do.
  for (int i = 0; i < kTrials; ++i) {
    EXPECT_EQ(finals[0][i] == finals[1][i], i < 1) << i;
  }
  std::remove(data.c_str());
  std::remove(bundle.c_str());
}

}  // namespace
}  // namespace tactus::internal
