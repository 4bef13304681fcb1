// `trainctl import` took a label that is not UTF-8, and printing it as JSON
// ended the program with an exception.
#include <hdf5.h>

#include <string>

#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/text.h"
#include "core/bundle/bundle.h"
#include "core/data/trial_file.h"
#include "core/files/csv.h"
#include "core/import/import.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/core/data/trial_samples.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"
#include "tools/common/json.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

constexpr char kBad[] = "H\xFF";

TEST(TextThatIsNotUtf8Test, IsRefusedByImport) {
  const ScratchDir dir;
  for (const std::string label : {kBad, "H\tU", "H\xC2\x85"}) {
    WriteBytes(dir / "a.csv",
               "# label=" + label + "\ntime,force,area,motion\n0,1,1,1\n");
    const absl::Status status = ImportTrials(dir / "a.csv", [](Trial) {
                                  return absl::OkStatus();
                                }).status();
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << label;
    EXPECT_TRUE(IsUtf8(std::string(status.message()))) << label;
  }
  WriteBytes(dir / "zero.csv", std::string("time,force\0,area,motion\n", 24));
  EXPECT_THAT(std::string(CsvTable::Read(dir / "zero.csv").status().message()),
              HasSubstr("line 1: holds a zero byte"));
}

TEST(TextThatIsNotUtf8Test, IsNotWrittenToATrialFile) {
  const ScratchDir dir;
  for (std::string Trial::*field :
       {&Trial::label, &Trial::condition, &Trial::object, &Trial::material,
        &Trial::layout, &Trial::id}) {
    Trial trial = FullTrial(1, 5);
    trial.*field = kBad;
    auto writer = TrialFileWriter::Create(dir / "a.h5", {.overwrite = true});
    ASSERT_TRUE(writer.ok());
    EXPECT_EQ(ReasonOf(writer->Append(trial)), "TRIAL_FILE_INVALID");
  }
}

TEST(TextThatIsNotUtf8Test, IsRefusedInTrialFilesOfOthers) {
  const ScratchDir dir;
  {
    auto writer = TrialFileWriter::Create(dir / "name.h5", {});
    ASSERT_TRUE(writer.ok() && writer->Append(FullTrial(1, 5)).ok());
    ASSERT_TRUE(writer->Close().ok());
  }
  WriteBytes(dir / "label.h5", ReadBytes(dir / "name.h5"));
  const hid_t named =
      H5Fopen((dir / "name.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Lmove(named, "/trials/000000", H5L_SAME_LOC, "/trials/\xFF",
                    H5P_DEFAULT, H5P_DEFAULT),
            0);
  H5Fclose(named);
  const hid_t labelled =
      H5Fopen((dir / "label.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t group = H5Gopen2(labelled, "/trials/000000", H5P_DEFAULT);
  const hid_t label = H5Aopen(group, "label", H5P_DEFAULT);
  const hid_t type = H5Aget_type(label);
  ASSERT_GE(H5Awrite(label, type, "\xFF\xFE"), 0);
  H5Tclose(type);
  H5Aclose(label);
  H5Gclose(group);
  H5Fclose(labelled);
  for (const char* name : {"name.h5", "label.h5"}) {
    auto reader = TrialFileReader::Open(dir / name);
    const absl::Status status =
        reader.ok() ? reader->ReadAll().status() : reader.status();
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << name;
    EXPECT_TRUE(IsUtf8(std::string(status.message()))) << name;
  }
}

TEST(TextThatIsNotUtf8Test, IsNotWrittenToABundle) {
  Model model = testing::SmallModel();
  model.class_names[1] = kBad;
  EXPECT_EQ(ReasonOf(EncodeBundle(model).status()), "INVALID_MODEL");
  for (std::string Provenance::*field :
       {&Provenance::command, &Provenance::version, &Provenance::data,
        &Provenance::note}) {
    model = testing::SmallModel();
    model.provenance.*field = kBad;
    EXPECT_EQ(ReasonOf(EncodeBundle(model).status()), "INVALID_MODEL");
  }
  model = testing::SmallModel();
  model.layout = *LayoutPreset("cody-forearm");
  model.layout.name = kBad;
  EXPECT_EQ(ReasonOf(EncodeBundle(model).status()), "INVALID_MODEL");
}

TEST(TextThatIsNotUtf8Test, IsRefusedInArguments) {
  const char* good[] = {"trainctl", "fit", "--note=gr\xC3\xBCn"};
  EXPECT_TRUE(CheckArguments(3, good).ok());
  const char* bad[] = {"trainctl", "fit", "--note=gr\xFCn"};
  const absl::Status status = CheckArguments(3, bad);
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("argument 2 is \"--note=gr?n\""));
}

// protobuf refuses what is not UTF-8; a line break would forge a log line.
TEST(TextThatIsNotUtf8Test, NamesOfAStreamAreOneLine) {
  const testing::TestModels models;
  void (*const spoils[])(v1::StreamConfig*) = {
      [](v1::StreamConfig* c) { c->set_model("a\nb"); },
      [](v1::StreamConfig* c) { c->set_client_id("a\nb"); },
      [](v1::StreamConfig* c) { c->mutable_geometry()->set_layout("a\nb"); },
  };
  for (const auto& spoil : spoils) {
    server::StreamSession session(&models, {});
    v1::ClassifyContactRequest request = testing::ConfigRequest();
    spoil(request.mutable_config());
    const absl::Status status = session.OnRequest(request);
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
    EXPECT_EQ(status.message().find('\n'), absl::string_view::npos);
  }
}

TEST(TextThatIsNotUtf8Test, ErrorsAndJsonTakeIt) {
  const absl::Status status = InvalidModel("name", kBad, "better\n");
  EXPECT_EQ(status.message(), "name is H?; it must be better?");
  EXPECT_EQ(InfoOf(status).metadata().at("value"), "H?");
  const client::Json json = {{"label", kBad}, {"value", std::nan("")}};
  EXPECT_EQ(client::JsonText(json),
            "{\"label\":\"H\xEF\xBF\xBD\",\"value\":null}");
}

}  // namespace
}  // namespace tactus::internal
