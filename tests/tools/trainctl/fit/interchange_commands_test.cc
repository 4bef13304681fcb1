// trainctl's commands that exchange models and trials with other programs.
#include <cmath>
#include <filesystem>

#include "core/base/errors.h"
#include "core/bundle/bundle.h"
#include "core/classify/warm_up.h"
#include "core/data/trial_file.h"
#include "core/files/draft_file.h"
#include "core/interchange/read_model_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/interchange/hmm_scores.h"
#include "tests/reference/lstm/plain_lstm.h"
#include "tests/support/small_model.h"
#include "tests/support/trainctl_run.h"
#include "tools/common/json.h"

namespace tactus::internal::client {
namespace {

using tactus::internal::testing::RunTrainctl;
using tactus::internal::testing::TrainctlRun;
using ::testing::HasSubstr;

std::string WriteBundle(const ScratchDir& dir) {
  Model model = tactus::internal::testing::SmallModel();
  tactus::internal::testing::AddLstms(2, model);
  for (int t = 0; t < 50; ++t) {
    model.warm_up.samples.push_back({{0.1 * t, 1e-4, 0.001 * t}, 0.1 * t});
  }
  EXPECT_TRUE(AnswerWarmUp(model).ok());
  const std::string path = dir / "old.tactus";
  WriteBytes(path, *EncodeBundle(model));
  return path;
}

Json Inside(const TrainctlRun& run) {
  EXPECT_TRUE(run.status.ok()) << run.status;
  return Json::parse(run.out, nullptr, /*allow_exceptions=*/false);
}

TEST(ModelsCommandTest, EveryExportComesBackAsTheSameModel) {
  const ScratchDir dir;
  const std::string bundle = WriteBundle(dir);
  const auto old = LoadModel(bundle);
  ASSERT_TRUE(old.ok()) << old.status();
  const std::pair<const char*, const char*> formats[] = {
      {"onnx", "lstm-sequence.onnx"},
      {"onnx", "lstm-step.onnx"},
      {"hmmlearn-json", "hmms.json"},
      {"hmmlearn-npz", "hmms.npz"},
      {"ghmm", "hmms-ghmm.json"}};
  for (const auto& [format, file] : formats) {
    const std::string out = dir / "exported/deep";
    Inside(RunTrainctl("bundle export " + bundle +
                       " --json --format=" + format + " --out=" + out));
    const std::string path = dir / "new.tactus";
    const Json report =
        Inside(RunTrainctl("bundle import " + out + "/" + file +
                           " --into=" + bundle + " --json --out=" + path));
    const bool onnx = std::string(format) == "onnx";
    EXPECT_EQ(report["networks"], onnx ? 2 : 0);
    EXPECT_EQ(report["classes_of_hmms"], onnx ? 0 : 4);
    const auto model = LoadModel(path);
    ASSERT_TRUE(model.ok()) << model.status();
    // The answers to the warm-up trial were computed anew.
    const WarmUpTrial& got = (*model)->model().warm_up;
    const WarmUpTrial& want = (*old)->model().warm_up;
    for (size_t k = 0; k < want.probability.size(); ++k) {
      EXPECT_NEAR(got.probability[k], want.probability[k], 1e-6);
    }
  }
}

TEST(ModelsCommandTest, SeveralFilesOfNetworksAreAveraged) {
  const ScratchDir dir;
  const std::string bundle = WriteBundle(dir);
  const std::string out = dir / "exported";
  Inside(RunTrainctl("bundle export " + bundle +
                     " --json --format=onnx --out=" + out));
  const std::string file = out + "/lstm-sequence.onnx";
  const Json report = Inside(
      RunTrainctl("bundle import " + file + " " + file + " --into=" + bundle +
                  " --json --out=" + dir / "new.tactus"));
  EXPECT_EQ(report["networks"], 4);
}

// Ideal signals of contacts whose force and motion are those of a class.
std::string WriteContacts(const ScratchDir& dir, const std::string& first) {
  const std::string path = dir / "held-out.h5";
  auto writer = TrialFileWriter::Create(path, {.overwrite = true});
  EXPECT_TRUE(writer.ok()) << writer.status();
  for (int i = 0; i < 16; ++i) {
    Trial trial;
    trial.label = i == 0 ? first : (i % 2 == 0 ? "HU" : "SM");
    for (int t = 0; t < 120; ++t) {
      trial.time.push_back(0.01 * t);
      const double force = (i % 2 == 0 ? 3 : 0.3) * (1 + 0.01 * i);
      trial.signals.push_back({force, 1e-4, i % 2 == 0 ? 0 : 1e-4 * t});
    }
    EXPECT_TRUE(writer->Append(trial).ok());
  }
  EXPECT_TRUE(writer->Close().ok());
  return path;
}

TEST(ModelsCommandTest, TheCalibrationIsFittedToHeldOutContacts) {
  const ScratchDir dir;
  const std::string bundle = WriteBundle(dir);
  const std::string out = dir / "new.tactus";
  Inside(RunTrainctl("bundle export " + bundle +
                     " --json --format=ghmm --out=" + dir.path()));
  const std::string import = "bundle import " + dir / "hmms-ghmm.json" +
                             " --into=" + bundle + " --json --out=" + out +
                             " --calibrate=";
  const Json report = Inside(RunTrainctl(import + WriteContacts(dir, "HU")));
  EXPECT_EQ(report["calibrated"], true);
  const auto before = LoadModel(bundle);
  const auto after = LoadModel(out);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_NE((*after)->model().calibration.frames,
            (*before)->model().calibration.frames);
  EXPECT_TRUE(RunWarmUp(**after).ok());

  const absl::Status status =
      RunTrainctl(import + WriteContacts(dir, "glass")).status;
  EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
  EXPECT_THAT(std::string(status.message()), HasSubstr("label \"glass\""));
}

TEST(ModelsCommandTest, MistakesAreNamed) {
  const ScratchDir dir;
  const std::string bundle = WriteBundle(dir);
  const auto status = [&](const std::string& arguments) {
    return RunTrainctl(arguments).status;
  };
  const std::string out = " --out=" + dir / "new";
  EXPECT_THAT(
      std::string(status("bundle export " + bundle + " --format=tflite" + out)
                      .message()),
      HasSubstr("onnx, hmmlearn-json, hmmlearn-npz or ghmm"));
  const absl::Status pickle =
      status("bundle import hmm.pkl --into=" + bundle + out);
  EXPECT_EQ(ReasonOf(pickle), "INVALID_MODEL");
  EXPECT_THAT(std::string(pickle.message()), HasSubstr("is a pickle"));
  EXPECT_THAT(
      std::string(
          status("bundle import x.h5 --activation=relu --into=" + bundle + out)
              .message()),
      HasSubstr("tanh or softsign"));
  EXPECT_FALSE(std::filesystem::exists(dir / "new"));
}

// The same values, with 0 for the masked taxel.
TaxelSeries AsFloats(const TaxelSeries& taxels, size_t masked) {
  TaxelSeries floats = taxels;
  floats.u16.clear();
  floats.scale = 1;
  floats.f32.resize(taxels.frames() * taxels.frame_size());
  for (size_t t = 0; t < taxels.frames(); ++t) {
    float* const frame = &floats.f32[t * taxels.frame_size()];
    taxels.Decode(t, frame);
    frame[masked] = 0;
  }
  return floats;
}

TEST(TrialsCommandTest, TrialsComeBackThroughEveryFormat) {
  const ScratchDir dir;
  const std::string data = dir / "trials.h5";
  std::vector<Trial> trials = {FullTrial(1, 20), FullTrial(2, 30, true)};
  trials[0].id = "000000";
  trials[1].id = "seven";
  auto writer = TrialFileWriter::Create(data, {});
  ASSERT_TRUE(writer.ok()) << writer.status();
  for (const Trial& trial : trials) ASSERT_TRUE(writer->Append(trial).ok());
  ASSERT_TRUE(writer->Close().ok());

  for (const std::string format : {"npz", "csv", "zarr", "hdf5"}) {
    const std::string out = dir / format;
    EXPECT_EQ(Inside(RunTrainctl("trials export " + data + " --json --format=" +
                                 format + " --out=" + out))["trials"],
              2);
    std::string back = out + "/trials.h5";
    if (format != "hdf5") {
      back = dir / (format + ".h5");
      Inside(RunTrainctl("import " + out + " --json --out=" + back));
    }
    const auto reader = TrialFileReader::Open(back);
    ASSERT_TRUE(reader.ok()) << reader.status();
    ASSERT_EQ(reader->size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      const auto trial = reader->Read(i);
      ASSERT_TRUE(trial.ok()) << trial.status();
      Trial want = trials[i];
      if (format == "csv") {
        // As docs/interchange.md says.
        want.source = "frames/" + want.id + ".csv";
        want.signals.clear();
        want.object_motion.clear();
        want.taxels = AsFloats(want.taxels, /*masked=*/5);
      }
      EXPECT_TRUE(SameBits(*trial, want)) << format;
    }
  }
  // The signals are trials themselves.
  Inside(RunTrainctl("import " + dir / "csv/signals" +
                     " --json --out=" + dir / "signals.h5"));
  const auto signals = TrialFileReader::Open(dir / "signals.h5");
  ASSERT_TRUE(signals.ok()) << signals.status();
  EXPECT_EQ(signals->Read(1)->signals, trials[1].signals);

  const std::string one = dir / "one";
  EXPECT_EQ(Inside(RunTrainctl(
                "trials export " + data +
                " --json --format=npz --trial=seven --out=" + one))["trials"],
            1);
  EXPECT_THAT(std::string(RunTrainctl("trials export " + data +
                                      " --format=npz --trial=8 --out=" + one)
                              .status.message()),
              HasSubstr("--trial is 8"));
}

// Exported models and plain loops give the raw scores that classify prints for
// the inputs that it prints.
TEST(ScoresTest, RawScoresAreThoseOfTheExportedModels) {
  const ScratchDir dir;
  const std::string bundle = WriteBundle(dir);
  const std::string data = WriteContacts(dir, "HU");
  const std::string classify =
      "classify --model=" + bundle + " --data=" + data + " --trial=000002";
  Inside(RunTrainctl("bundle export " + bundle +
                     " --json --format=onnx --out=" + dir.path()));
  Inside(RunTrainctl("bundle export " + bundle +
                     " --json --format=hmmlearn-json --out=" + dir.path()));
  const auto networks = ReadModelFile(dir / "lstm-sequence.onnx");
  const auto hmms = ReadModelFile(dir / "hmms.json");
  ASSERT_TRUE(networks.ok() && hmms.ok());
  const Json scores = Inside(RunTrainctl(classify + " --scores --json"));
  EXPECT_EQ(scores["lstm_inputs"], Json({"force", "motion"}));
  ASSERT_EQ(scores["trials"].size(), 1u);
  Rows lstm_inputs;
  Rows lstm_raw;
  Rows hmm_inputs;
  for (const Json& step : scores["trials"][0]["steps"]) {
    if (step.contains("lstm_inputs")) {
      lstm_inputs.push_back(step["lstm_inputs"]);
      lstm_raw.push_back(step["lstm_raw"]);
      // The trial's force, log(x + 0.01).
      EXPECT_NEAR(lstm_inputs.back()[0], std::log(3 * 1.02 + 0.01), 1e-9);
      // This bundle calibrates networks by nothing.
      EXPECT_LE(LargestDifference(
                    {step["lstm_calibrated"].get<std::vector<double>>()},
                    {lstm_raw.back()}),
                1e-9);
    }
    if (step.contains("hmm_inputs")) {
      hmm_inputs.push_back(step["hmm_inputs"]);
      for (size_t k = 0; k < 4; ++k) {
        const double want = LogLikelihood(hmms->hmms[k].mixture, hmm_inputs);
        // Steps are computed in float.
        EXPECT_NEAR(step["hmm_raw"][k], want, 1e-6 * std::abs(want));
      }
    }
  }
  ASSERT_GT(lstm_inputs.size(), 5u);
  ASSERT_EQ(networks->lstms.size(), 2u);
  const Rows a = PlainLstm(networks->lstms[0], lstm_inputs);
  const Rows b = PlainLstm(networks->lstms[1], lstm_inputs);
  for (size_t t = 0; t < a.size(); ++t) {
    for (size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(lstm_raw[t][k], (a[t][k] + b[t][k]) / 2, 1e-5);
    }
  }
  const TrainctlRun text = RunTrainctl(classify + " --scores");
  EXPECT_THAT(text.out, HasSubstr("lstm raw"));
  EXPECT_THAT(text.out, HasSubstr("hmm calibrated"));
}

TEST(ScoresTest, ABundleWithoutNetworksHasTheScoresOfItsHmms) {
  const ScratchDir dir;
  WriteBytes(dir / "hmms.tactus",
             *EncodeBundle(tactus::internal::testing::SmallModel()));
  const Json scores = Inside(
      RunTrainctl("classify --scores --json --model=" + dir / "hmms.tactus" +
                  " --data=" + WriteContacts(dir, "HU")));
  for (const Json& trial : scores["trials"]) {
    ASSERT_FALSE(trial["steps"].empty());
    for (const Json& step : trial["steps"]) {
      EXPECT_FALSE(step.contains("lstm_raw"));
      EXPECT_EQ(step["hmm_inputs"].size(), 2u);
    }
  }
  EXPECT_EQ(
      ReasonOf(RunTrainctl("classify --trial=x --model=" + dir / "hmms.tactus" +
                           " --data=" + WriteContacts(dir, "HU"))
                   .status),
      "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal::client
