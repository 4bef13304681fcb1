// What an operator sees and does at a terminal: trainctl record, and
// tactus-stream --monitor.
#include <filesystem>
#include <fstream>

#include "client/drivers/calibration/calibration_json.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/flat_layout.h"
#include "tests/support/pty_program.h"

namespace tactus::internal::client {
namespace {

using tactus::internal::testing::ChildTactusd;
using tactus::internal::testing::PtyProgram;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr char kLeave[] = "\x1b[0m\x1b[?25h\x1b[?1049l";

// A folder with touches.h5: 0.9 s of nothing, 0.3 s of touch, 0.6 s of
// nothing, again and again, with an offset of 20 counts and noise.
class AtTheTerminalTest : public ::testing::Test {
 protected:
  AtTheTerminalTest()
      : folder_(fs::path(::testing::TempDir()) / "at_the_terminal") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    auto writer = TrialFileWriter::Create(Path("touches.h5"), {});
    EXPECT_TRUE(writer.ok());
    for (int i = 0; i < 20; ++i) {
      EXPECT_TRUE(writer->Append(Touch(i)).ok());
    }
    EXPECT_TRUE(writer->Close().ok());
  }
  ~AtTheTerminalTest() override { fs::remove_all(folder_); }

  static Trial Touch(int number) {
    Trial trial;
    trial.label = "any";
    SetSkin(tactus::internal::testing::FlatLayout("bench", 4, 6,
                                                  TaxelUnit::kCounts, 30, 40),
            trial);
    trial.taxels.rows = 4;
    trial.taxels.columns = 6;
    for (int t = 0; t < 180; ++t) {
      trial.time.push_back(0.01 * t);
      for (int i = 0; i < 24; ++i) {
        const bool touched = t >= 90 && t < 120 && i == 8;
        trial.taxels.u16.push_back(static_cast<uint16_t>(
            20 + (t * 7 + i * 3 + number) % 3 + (touched ? 200 : 0)));
      }
    }
    return trial;
  }
  std::string Path(const std::string& name) const { return folder_ / name; }
  std::vector<std::string> Record(std::vector<std::string> more = {}) const {
    std::vector<std::string> command = {
        TRAINCTL,          "record",
        "--driver=replay", "--data=" + Path("touches.h5"),
        "--labels=HU,HM",  "--out=" + Path("out.h5")};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
  static std::vector<std::string> LabelsIn(const std::string& path) {
    std::vector<std::string> labels;
    const auto reader = TrialFileReader::Open(path);
    EXPECT_TRUE(reader.ok()) << reader.status();
    for (size_t i = 0; reader.ok() && i < reader->size(); ++i) {
      labels.push_back(reader->Read(i)->label);
    }
    return labels;
  }

  const fs::path folder_;
};

TEST_F(AtTheTerminalTest, LabelsTrialsUndoesAndQuits) {
  PtyProgram program(Record());
  ASSERT_TRUE(program.WaitFor("bench, 4 x 6 taxels at 100 Hz"));
  ASSERT_TRUE(program.WaitFor("measured rate: 100.00 Hz"));
  ASSERT_TRUE(program.WaitFor("press the key of a label"));
  program.Type("2");
  ASSERT_TRUE(program.WaitFor("waiting for a touch: HM"));
  ASSERT_TRUE(program.WaitFor("RECORDING HM"));
  ASSERT_TRUE(program.WaitFor("kept: HU 0   HM 1"));
  program.Type("1");
  ASSERT_TRUE(program.WaitFor("kept: HU 1   HM 1"));
  program.Type("u");
  ASSERT_TRUE(program.WaitFor("kept: HU 0   HM 1"));
  ASSERT_TRUE(program.WaitFor("kept: HU 1   HM 1"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
  EXPECT_THAT(program.output(), HasSubstr("out.h5: 2 trials"));
  EXPECT_THAT(program.output(), HasSubstr(kLeave));
  EXPECT_TRUE(program.IsRestored());
  EXPECT_THAT(LabelsIn(Path("out.h5")), ElementsAre("HM", "HU"));
}

TEST_F(AtTheTerminalTest, CtrlCLosesNothing) {
  PtyProgram program(Record());
  ASSERT_TRUE(program.WaitFor("press the key"));
  program.Type("1");
  ASSERT_TRUE(program.WaitFor("kept: HU 1"));
  // As the terminal sends it.
  program.Type("\x03");
  EXPECT_EQ(program.Wait(), 0);
  EXPECT_TRUE(program.IsRestored());
  EXPECT_THAT(LabelsIn(Path("out.h5")), ElementsAre("HU"));
}

TEST_F(AtTheTerminalTest, AKilledSessionGoesOn) {
  {
    PtyProgram program(Record());
    ASSERT_TRUE(program.WaitFor("press the key"));
    program.Type("1");
    ASSERT_TRUE(program.WaitFor("kept: HU 1"));
    program.Signal(SIGKILL);
    EXPECT_EQ(program.Wait(), -SIGKILL);
  }
  EXPECT_FALSE(fs::exists(Path("out.h5")));
  PtyProgram program(Record());
  ASSERT_TRUE(program.WaitFor("1 trials of an interrupted session are kept"));
  ASSERT_TRUE(program.WaitFor("press the key"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
  EXPECT_THAT(LabelsIn(Path("out.h5")), ElementsAre("HU"));
}

// A tare of 50 frames takes the offset away; the raw frames stay.
TEST_F(AtTheTerminalTest, TaredTrialsHaveTheirRawFramesBesideThem) {
  PtyProgram program(Record({"--tare=50"}));
  ASSERT_TRUE(program.WaitFor("nothing must touch the skin"));
  ASSERT_TRUE(program.WaitFor("press the key"));
  program.Type("1");
  ASSERT_TRUE(program.WaitFor("kept: HU 1"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
  const auto tared = TrialFileReader::Open(Path("out.h5"))->Read(0);
  const auto raw = TrialFileReader::Open(Path("out.raw.h5"))->Read(0);
  ASSERT_TRUE(tared.ok() && raw.ok());
  ASSERT_FALSE(tared->taxels.f32.empty());
  EXPECT_LT(tared->taxels.f32[0], 3);
  EXPECT_GE(raw->taxels.u16[0], 20);
  EXPECT_EQ(raw->time, tared->time);
}

TEST_F(AtTheTerminalTest, ATouchedSkinIsNotTared) {
  PtyProgram program(Record({"--tare=110"}));
  EXPECT_EQ(program.Wait(), 1);
  EXPECT_THAT(program.output(), HasSubstr("the skin is touched: taxel 8"));
  EXPECT_TRUE(program.IsRestored());
}

TEST_F(AtTheTerminalTest, ACalibrationIsMeasuredAndUsed) {
  PtyProgram calibrate({TRAINCTL, "skin", "calibrate", "--driver=replay",
                        "--data=" + Path("touches.h5"), "--frames=80",
                        "--out=" + Path("cal.json"),
                        "--layout-out=" + Path("skin.json")});
  EXPECT_EQ(calibrate.Wait(), 0) << calibrate.output();
  std::ifstream file(Path("cal.json"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto made = CalibrationFromJson(text);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->device, "replay");
  EXPECT_NEAR(made->baseline[8], 21, 0.2);
  PtyProgram other(
      Record({"--calibration=" + Path("cal.json"), "--device-id=other"}));
  EXPECT_EQ(other.Wait(), 1);
  EXPECT_THAT(other.output(), HasSubstr("device of the calibration"));
  PtyProgram program(Record({"--calibration=" + Path("cal.json")}));
  ASSERT_TRUE(program.WaitFor("press the key"));
  program.Type("1");
  ASSERT_TRUE(program.WaitFor("kept: HU 1"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
  const auto trial = TrialFileReader::Open(Path("out.h5"))->Read(0);
  ASSERT_TRUE(trial.ok());
  EXPECT_EQ(trial->taxels.f32[0], 0);
}

// A skin of three axes that is pressed and pulled at, 100 counts a newton.
Trial Pull(int number) {
  Trial trial;
  trial.label = "any";
  SkinLayout layout = tactus::internal::testing::FlatLayout(
      "pulled", 4, 6, TaxelUnit::kNewton, 0.3, 0.4);
  layout.axes = 3;
  layout.normal_axis = 2;
  layout.signed_values = true;
  SetSkin(layout, trial);
  trial.taxels.SetShape(layout);
  constexpr int kPull[] = {50, -30, 200};
  for (int t = 0; t < 180; ++t) {
    trial.time.push_back(0.01 * t);
    for (int i = 0; i < 72; ++i) {
      const bool touched = t >= 90 && t < 120 && i / 3 == 8;
      trial.taxels.i16.push_back(static_cast<int16_t>(
          100 * (i % 3) - 70 + (t * 7 + i * 5 + number) % 3 +
          (touched ? kPull[i % 3] : 0)));
    }
  }
  return trial;
}

TEST_F(AtTheTerminalTest, ThreeAxesAreCalibratedByKnownLoads) {
  const std::string data = "--data=" + Path("pulls.h5");
  auto writer = TrialFileWriter::Create(Path("pulls.h5"), {});
  ASSERT_TRUE(writer.ok());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(writer->Append(Pull(i)).ok());
  ASSERT_TRUE(writer->Close().ok());
  std::ofstream(Path("loads.csv"))
      << "taxel,reading_x,reading_y,reading_z,load_x,load_y,load_z\n"
         "*,100,0,0,1,0,0\n*,0,100,0,0,1,0\n*,0,0,100,0,0,1\n"
         "*,0,0,200,0,0,2.1\n";
  std::ofstream(Path("gains.csv")) << "taxel,reading,load\n*,40,1\n";
  const std::vector<std::string> calibrate = {
      TRAINCTL,
      "skin",
      "calibrate",
      "--driver=replay",
      data,
      "--frames=80",
      "--out=" + Path("cal.json"),
      "--layout-out=" + Path("skin.json")};
  const auto with = [](std::vector<std::string> command,
                       const std::string& option) {
    command.push_back(option);
    return command;
  };
  PtyProgram gains(with(calibrate, "--gains=" + Path("gains.csv")));
  EXPECT_EQ(gains.Wait(), 2);
  EXPECT_THAT(gains.output(),
              HasSubstr("--gains is given for a skin of three axes"));
  EXPECT_FALSE(fs::exists(Path("cal.json")));
  PtyProgram loads(with(calibrate, "--loads=" + Path("loads.csv")));
  EXPECT_EQ(loads.Wait(), 0) << loads.output();
  // By hand: (100 x 1 + 200 x 2.1) / (100^2 + 200^2) = 0.0104 newtons a count
  // leave errors of 0.04 and -0.02 newtons in four lines.
  EXPECT_THAT(loads.output(),
              HasSubstr("loads of 4 lines are fitted with an error (RMS) of "));
  EXPECT_THAT(loads.output(), HasSubstr("0.0224 newtons along x, y and z"));
  std::ifstream file(Path("cal.json"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto made = CalibrationFromJson(text);
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_EQ(made->cross_axis.size(), 1U);
  ASSERT_EQ(made->baseline.size(), 72U);
  EXPECT_NEAR(made->baseline[8 * 3 + 2], 131, 0.2);
  EXPECT_NEAR(made->cross_axis[0]->rows[2][2], 0.0104, 1e-12);
  PtyProgram program({TRAINCTL, "record", "--driver=replay", data,
                      "--labels=HU,HM", "--out=" + Path("out.h5"),
                      "--calibration=" + Path("cal.json")});
  ASSERT_TRUE(program.WaitFor("press the key"));
  program.Type("1");
  ASSERT_TRUE(program.WaitFor("kept: HU 1"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
  const auto trial = TrialFileReader::Open(Path("out.h5"))->Read(0);
  ASSERT_TRUE(trial.ok());
  const std::vector<float>& values = trial->taxels.f32;
  ASSERT_GT(values.size(), 72U * 70);
  // Half a second before the touch, and in it.
  for (int i = 0; i < 72; ++i) EXPECT_EQ(values[i], 0) << i;
  const float* pulled = &values[72 * 60 + 24];
  EXPECT_NEAR(pulled[0], 0.5, 0.02);
  EXPECT_NEAR(pulled[1], -0.3, 0.02);
  EXPECT_NEAR(pulled[2], 2.08, 0.03);
}

TEST_F(AtTheTerminalTest, AServersModelIsOptional) {
  PtyProgram program(Record({"--server=unix:" + Path("nobody.sock")}));
  ASSERT_TRUE(program.WaitFor("no model: "));
  program.Type("1");
  ASSERT_TRUE(program.WaitFor("kept: HU 1"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
}

// The built-in model does not know this skin; its trials are uploaded all the
// same.
TEST_F(AtTheTerminalTest, TrialsAreUploadedInTheEnd) {
  ChildTactusd server({"--data-dir=" + Path("data")});
  ASSERT_NE(server.port(), 0);
  const std::string at = "--server=" + server.address();
  PtyProgram early(Record({at, "--dataset=bench"}));
  EXPECT_EQ(early.Wait(), 1);
  EXPECT_THAT(early.output(), HasSubstr("DATASET_NOT_FOUND"));
  PtyProgram create({TRAINCTL, "datasets", "create", "bench", at});
  EXPECT_EQ(create.Wait(), 0) << create.output();
  PtyProgram program(Record({at, "--dataset=bench"}));
  ASSERT_TRUE(program.WaitFor("no model: "));
  program.Type("1");
  ASSERT_TRUE(program.WaitFor("kept: HU 1"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
  EXPECT_THAT(program.output(), HasSubstr("datasets/bench/versions/1"));
  EXPECT_THAT(program.output(), HasSubstr("(HU 1)"));
}

TEST_F(AtTheTerminalTest, ShowsWhatAServedModelThinks) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  PtyProgram program({TRAINCTL, "record", "--driver=sim", "--labels=a,b",
                      "--out=" + Path("sim.h5"),
                      "--server=" + server.address()});
  ASSERT_TRUE(program.WaitFor("models/default/versions/1"));
  ASSERT_TRUE(program.WaitFor("answer p50"));
  program.Type("2");
  ASSERT_TRUE(program.WaitFor("decided "));
  ASSERT_TRUE(program.WaitFor("RECORDING b"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
}

TEST_F(AtTheTerminalTest, WithoutATerminalBothProgramsSaySo) {
  const std::pair<std::string, const char*> commands[] = {
      {std::string(TRAINCTL) + " record --driver=replay --data=" +
           Path("touches.h5") + " --labels=a --out=" + Path("out.h5"),
       "trainctl record is used without a terminal"},
      {std::string(TACTUS_STREAM) + " --driver=sim --monitor",
       "--monitor is used without a terminal"}};
  for (const auto& [command, message] : commands) {
    std::FILE* pipe = popen((command + " 2>&1 </dev/null").c_str(), "r");
    std::string output(10'000, 0);
    output.resize(std::fread(output.data(), 1, output.size(), pipe));
    EXPECT_NE(pclose(pipe), 0);
    EXPECT_THAT(output, HasSubstr(message));
  }
}

TEST_F(AtTheTerminalTest, TheMonitorShowsContactsAndFitsItsTerminal) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  PtyProgram program({TACTUS_STREAM, "--server=" + server.address(),
                      "--driver=sim", "--monitor"},
                     /*colour=*/true);
  ASSERT_TRUE(program.WaitFor("models/default/versions/1"));
  ASSERT_TRUE(program.WaitFor("▀"));
  ASSERT_TRUE(program.WaitFor("contact 1 "));
  ASSERT_TRUE(program.WaitFor("HU"));
  program.Resize(100, 30);
  // Clears the screen, because its size changed.
  ASSERT_TRUE(program.WaitFor("\x1b[2J"));
  program.Type("q");
  EXPECT_EQ(program.Wait(), 0);
  EXPECT_THAT(program.output(), HasSubstr(kLeave));
  EXPECT_TRUE(program.IsRestored());
}

TEST_F(AtTheTerminalTest, AnErrorOfTheServerEndsTheMonitorAndItsScreen) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  PtyProgram program({TACTUS_STREAM, "--server=" + server.address(),
                      "--driver=sim", "--model=models/none", "--monitor"});
  EXPECT_EQ(program.Wait(), 1);
  EXPECT_TRUE(program.IsRestored());
  const size_t left = program.output().find(kLeave);
  ASSERT_NE(left, std::string::npos);
  EXPECT_THAT(program.output().substr(left), HasSubstr("models/none"));
}

}  // namespace
}  // namespace tactus::internal::client
