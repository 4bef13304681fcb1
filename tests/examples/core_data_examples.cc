// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <fstream>
#include <iostream>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/rate_watch.h"
#include "core/base/status_macros.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/recording/contact_cutter.h"
#include "core/data/recording/foxglove_image.h"
#include "core/data/recording/message_schema.h"
#include "core/data/recording/recording.h"
#include "core/data/recording/recording_reader.h"
#include "core/data/recording/recording_writer.h"
#include "core/data/similar_names.h"
#include "core/data/trial.h"
#include "core/data/trial_csv.h"
#include "core/data/trial_file.h"
#include "core/data/trial_id.h"
#include "core/data/trial_layout.h"
#include "core/data/trial_npz.h"
#include "core/data/trial_record.h"
#include "core/files/array_file.h"
#include "core/files/array_order.h"
#include "core/files/cell_advice.h"
#include "core/files/csv.h"
#include "core/files/draft_file.h"
#include "core/files/file_bytes.h"
#include "core/files/hdf5_array.h"
#include "core/files/hdf5_filters.h"
#include "core/files/hdf5_handle.h"
#include "core/files/hdf5_probe.h"
#include "core/files/hdf5_read.h"
#include "core/files/mcap/mcap_reader.h"
#include "core/files/mcap/mcap_records.h"
#include "core/files/mcap/mcap_writer.h"
#include "core/files/npy.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/files/number_cells.h"
#include "core/files/number_text.h"
#include "core/files/text_cells.h"
#include "core/files/text_lines.h"
#include "core/import/event_frames.h"
#include "core/import/file_names.h"
#include "core/import/frame_columns.h"
#include "core/import/idle_noise.h"
#include "core/import/import.h"
#include "core/import/import_notes.h"
#include "core/import/import_recording.h"
#include "core/import/import_skin_folder.h"
#include "core/import/light_noise.h"
#include "core/import/mistakes.h"
#include "core/import/odd_rates.h"
#include "core/import/rate_check.h"
#include "core/import/recorded_frames.h"
#include "core/import/rising_columns.h"
#include "core/import/ros_bag.h"
#include "core/import/ros_message.h"
#include "core/import/skin_file.h"
#include "core/import/trial_table.h"

namespace tactus::examples {

absl::Status Use(Trial trial);

void Remark(const Trial& trial);

absl::Status TrialIdExample(
    Trial trial,
    absl::Status (*complain)(const char* field, const std::string& fault)) {
  const std::string fault = TrialIdFault(trial.id);
  if (!fault.empty()) return complain("id", fault);

  TrialIds ids;
  trial.id = ids.Unique(trial.id);  // "touch 1" -> "touch_1"
  return absl::OkStatus();
}

void FrameFingerprintExample(const Trial& trial, std::set<std::string>& seen) {
  const std::string fingerprint = FrameFingerprint(trial);
  if (IdentifiesRecording(fingerprint) && !seen.insert(fingerprint).second) {
    Remark(trial);  // the same frames once more
  }
}

absl::Status ContactCutterExample(const v1::StreamConfig& config,
                                  const SkinLayout& layout,
                                  const v1::FrameBatch& frame) {
  ContactCutter cutter("run.mcap", config, layout);
  TACTUS_ASSIGN_OR_RETURN(const bool ended, cutter.Add(frame));
  if (ended) Use(cutter.Take());
  if (cutter.EndTrial()) Use(cutter.Take());
  return absl::OkStatus();
}

using v1::TAXEL_TYPE_UINT16;

void FoxgloveImageExample(const SkinLayout& layout,
                          const v1::FrameBatch& batch) {
  FoxgloveImage image(layout);
  const McapSchema schema = FoxgloveImage::Schema();
  const std::string bytes = image.Encode(batch, TAXEL_TYPE_UINT16, 0.001);
}

void MessageSchemaExample() {
  const McapSchema schema = MessageSchema(*v1::Posterior::descriptor());
}

void RecordingExample() {
  RecordingEvent event = RecordedTrial{{{"label", "HU"}}};
  if (const auto* trial = std::get_if<RecordedTrial>(&event)) {
    trial->Text("label");
  }
}

void Use(const v1::FrameBatch& frame);

absl::Status RecordingReaderExample() {
  TACTUS_ASSIGN_OR_RETURN(const auto reader, RecordingReader::Open("run.mcap"));
  RecordingEvent event;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const bool more, reader->Next(event));
    if (!more) break;
    if (const auto* frame = std::get_if<v1::FrameBatch>(&event)) Use(*frame);
  }
  reader->CutOff();  // empty, or where the recording was cut off
  return absl::OkStatus();
}

absl::Status RecordingWriterExample(const v1::StreamConfig& config,
                                    const v1::FrameBatch& frame) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto writer,
      RecordingWriter::Create("run.mcap", {{"driver", "sim"}}, {}));
  TACTUS_RETURN_IF_ERROR(writer->Write(config));
  TACTUS_RETURN_IF_ERROR(writer->Write(frame));
  TACTUS_RETURN_IF_ERROR(writer->Finish({{"frames", "1"}}));
  return absl::OkStatus();
}

absl::Status ArrayFileExample() {
  TACTUS_ASSIGN_OR_RETURN(const ArrayFile file,
                          ReadArrayFile("trial.h5", "run1/taxels"));
  file.array.shape;  // {605, 384}
  return absl::OkStatus();
}

absl::Status NumberTextExample() {
  TACTUS_ASSIGN_OR_RETURN(
      const NumberText table,
      ParseNumberText("a.csv", "time;force\n0;0,5\n1;0,75\n", {}));
  table.header;  // {"time", "force"}
  table.found;   // "cells are separated by semicolons, ..."
  return absl::OkStatus();
}

void NumberCellsExample() {
  double value = 0;
  ParseCell("0,5", ',', &value);  // true, 0.5
  IsMissing("NaN");               // true
}

void Use(size_t number, absl::string_view line);

void TextLinesExample(const std::string& text) {
  TextLines lines(text);
  while (lines.Next()) Use(lines.number(), lines.line());
}

void TextCellsExample() {
  std::vector<absl::string_view> cells;
  SplitCells("1;\"a;b\"; 3 ", ';', &cells);  // {"1", "a;b", "3"}
}

absl::Status Hdf5FiltersExample(hid_t properties,
                                const Hdf5Complaint& complain) {
  TACTUS_RETURN_IF_ERROR(CheckFilters(properties, "taxels", complain));
  return absl::OkStatus();
}

absl::Status Hdf5ArrayExample() {
  TACTUS_ASSIGN_OR_RETURN(const NpyArray array,
                          ReadHdf5Array("trial.h5", "run1/taxels", {}));
  return absl::OkStatus();
}

void ArrayOrderExample() {
  FromColumnsFirst({2, 3}, std::vector{1, 4, 2, 5, 3, 6});
  // {1, 2, 3, 4, 5, 6}
}

void SimilarNamesExample(const std::vector<Trial>& trials) {
  SimilarNames labels("label");
  for (const Trial& trial : trials) labels.Add(trial.label);
  labels.Remarks();  // {"the labels \"Soft\" and \"soft\" differ ..."}
}

absl::Status MistakesExample(const std::map<std::string, absl::Status>& read) {
  Mistakes mistakes("trials.csv");
  for (const auto& [file, status] : read) {
    TACTUS_RETURN_IF_ERROR(mistakes.Add(file, status));
  }
  TACTUS_RETURN_IF_ERROR(mistakes.Status());
  return absl::OkStatus();
}

absl::Status FileNamesExample() {
  TACTUS_ASSIGN_OR_RETURN(const FileNamePattern pattern,
                          FileNamePattern::Parse("{label}_{group}.csv"));
  TACTUS_ASSIGN_OR_RETURN(const auto fields, pattern.Match("cup_anna.csv"));
  fields.at("group");  // "anna"
  return absl::OkStatus();
}

absl::Status FrameColumnsExample(const ArrayFile& file, const SkinFile& skin) {
  TACTUS_ASSIGN_OR_RETURN(const FrameColumns columns,
                          FindFrameColumns("a.csv", file, skin));
  columns.taxels;  // {1, 2, 3}
  return absl::OkStatus();
}

absl::Status ImportNotesExample(const ArrayFile& file,
                                const RecordedFrames& frames) {
  ImportNotes notes;
  notes.AddFound("0.csv", file.found, frames.found);
  TACTUS_RETURN_IF_ERROR(notes.Check("skin.json"));
  notes.Tell([](const std::string& text) { std::cerr << text << "\n"; });
  return absl::OkStatus();
}

void RisingColumnsExample(const std::vector<ArrayFile>& files,
                          const std::vector<size_t>& columns) {
  RisingColumns rising;
  for (const ArrayFile& file : files) {
    rising.Add(FindRising(file, columns), file.array.shape[0]);
  }
  rising.Always();
}

void CellAdviceExample() {
  CellAdvice("12:30:01", '.');
  CellAdvice("label", '.');
}

void RateCheckExample() {
  const RateCheck check = CheckRate({0, 0.02, 0.04}, /*stated_hz=*/50);
  check.measured_hz;  // 50
  check.error;        // empty
}

void Print(const std::string& text);

void OddRatesExample(const Trial& trial) {
  OddRates odd;
  odd.Add("0.csv", /*stated_hz=*/100, /*measured_hz=*/90);
  odd.Add(trial);
  if (!odd.empty()) Print(odd.Remark());
}

void Tell(double hz);

void RateWatchExample(int64_t capture_time_ns) {
  RateWatch watch(/*stated_hz=*/100);
  if (watch.Add(/*frames=*/1, capture_time_ns)) Tell(watch.measured_hz());
}

absl::Status RosBagExample() {
  TACTUS_ASSIGN_OR_RETURN(
      const ArrayFile file,
      ReadBag("run1.bag", {.frames = "/skin/taxels", .pose = "/arm/pose"}));
  file.header;  // "time", "x" ... "qw", then one name per taxel
  return absl::OkStatus();
}

absl::Status RosMessageExample(absl::string_view text,
                               absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(const auto type, RosMessageType::Parse(text));
  TACTUS_ASSIGN_OR_RETURN(const RosNumbers numbers, type.Read(bytes));
  numbers.at("values_z");  // one per taxel
  return absl::OkStatus();
}

absl::Status CsvExample() {
  TACTUS_ASSIGN_OR_RETURN(CsvTable table, CsvTable::Read("index.csv"));
  TACTUS_ASSIGN_OR_RETURN(size_t object, table.Column("object"));
  table.text(0, object);
  return absl::OkStatus();
}

absl::Status DraftFileExample(const std::string& bytes) {
  TACTUS_ASSIGN_OR_RETURN(DraftFile draft, DraftFile::Create("model.tactus"));
  std::ofstream(draft.path()) << bytes;
  TACTUS_RETURN_IF_ERROR(draft.Publish());
  return absl::OkStatus();
}

absl::Status EventFramesExample(const std::string& path, const ArrayFile& file,
                                const SkinFile& skin) {
  TACTUS_ASSIGN_OR_RETURN(const EventFrames frames,
                          MakeEventFrames(path, file, skin, /*rate_hz=*/100));
  return absl::OkStatus();
}

absl::Status FileBytesExample(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(std::string text, ReadFileBytes(path, 1 << 20));
  return absl::OkStatus();
}

absl::Status Hdf5HandleExample(const char* path) {
  const Hdf5Quiet quiet;
  Hdf5Handle file(H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.ok()) return TrialFileInvalid(path, Hdf5LastError());
  return absl::OkStatus();
}

absl::Status ReadItAll(const std::string& path);

absl::Status Hdf5ProbeExample(const std::string& path) {
  TACTUS_RETURN_IF_ERROR(ProbeInChild(path, [&] { return ReadItAll(path); }));
  return absl::OkStatus();
}

absl::Status Hdf5ReadExample(const std::string& path, hid_t group) {
  const Hdf5Complaint complain(path, "000007");
  double rate = 100;
  TACTUS_RETURN_IF_ERROR(ReadNumber(group, "sample_rate_hz", complain, &rate));
  return absl::OkStatus();
}

void Use(const McapMessage& message);

absl::Status McapReaderExample() {
  TACTUS_ASSIGN_OR_RETURN(const auto reader, McapReader::Open("run.mcap"));
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const McapRead read, reader->Next());
    if (read == McapRead::kEnd) break;
    if (read == McapRead::kMessage) Use(reader->message());
  }
  reader->complete();  // false if the file was cut off
  return absl::OkStatus();
}

void McapRecordsExample() {
  std::string content;
  PutMcapNumber<uint16_t>(7, &content);
  PutMcapText("topic", &content);
  McapCursor cursor(content);
  cursor.Number<uint16_t>();  // 7
}

absl::Status McapWriterExample(uint64_t time_ns) {
  TACTUS_ASSIGN_OR_RETURN(const auto writer,
                          McapWriter::Create("run.mcap", {}));
  const uint16_t schema = writer->AddSchema({"Point", "jsonschema", "{}"});
  const uint16_t topic = writer->AddChannel({schema, "/point", "json", {}});
  TACTUS_RETURN_IF_ERROR(writer->Write(topic, time_ns, R"({"x": 1})"));
  TACTUS_RETURN_IF_ERROR(writer->Finish());
  return absl::OkStatus();
}

void NpyWriteExample(const std::vector<double>& values) {
  const std::string bytes = NpyBytes({2, 3}, std::span<const double>(values));
  NpyText({"HU", "HM"});  // numpy.array(["HU", "HM"])
}

absl::Status NpzExample(const std::vector<double>& time) {
  const std::string bytes = *NpzBytes({{"time", NpyBytes({2}, time)}});
  TACTUS_ASSIGN_OR_RETURN(NpzArrays arrays, ParseNpz("a.npz", bytes));
  arrays.at("time").f64;
  TACTUS_ASSIGN_OR_RETURN(NpyArray again, ReadNpz("trial.npz", "time"));
  return absl::OkStatus();
}

absl::Status TrialNpzExample(const Trial& trial) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes, TrialToNpz(trial));
  TACTUS_ASSIGN_OR_RETURN(Trial back, TrialFromNpz("000007.npz", bytes));
  return absl::OkStatus();
}

absl::Status TrialCsvExample(const Trial& trial) {
  TACTUS_ASSIGN_OR_RETURN(const std::string table, SignalsToCsv(trial));
  TACTUS_RETURN_IF_ERROR(WriteFileBytes("000007.csv", table));
  return absl::OkStatus();
}

absl::Status IdleNoiseExample(const std::vector<Trial>& trials) {
  IdleNoise noise({.frames = 10});
  for (const Trial& trial : trials) noise.Add(trial);
  TACTUS_ASSIGN_OR_RETURN(const IdleEstimate found, noise.Estimate());
  return absl::OkStatus();
}

void LightNoiseExample(const std::vector<Trial>& trials, SkinLayout& layout) {
  LightNoise noise(/*frames=*/1000);
  for (const Trial& trial : trials) noise.Add(trial);
  if (const auto light = noise.Estimate()) layout.light_touch = *light;
}

absl::Status ImportRecordingExample() {
  TACTUS_ASSIGN_OR_RETURN(
      const size_t trials,
      ImportRecording("run.mcap", {}, [&](Trial t) { return Use(t); }));
  return absl::OkStatus();
}

absl::Status ImportSkinFolderExample() {
  TACTUS_ASSIGN_OR_RETURN(
      const size_t trials,
      ImportSkinFolder("mine", {}, [&](Trial t) { return Use(t); }));
  return absl::OkStatus();
}

absl::Status ImportExample(const std::string& dir, const std::string& out) {
  TACTUS_ASSIGN_OR_RETURN(auto writer, TrialFileWriter::Create(out, {}));
  TACTUS_RETURN_IF_ERROR(ImportTrials(dir, [&](Trial trial) {
                           return writer.Append(trial);
                         }).status());
  return absl::OkStatus();
}

absl::Status NpyExample() {
  TACTUS_ASSIGN_OR_RETURN(NpyArray array, ReadNpy("trials/0000.npy"));
  return absl::OkStatus();
}

absl::Status RecordedFramesExample(const std::string& path,
                                   const ArrayFile& file,
                                   const SkinFile& skin) {
  TACTUS_ASSIGN_OR_RETURN(RecordedFrames frames,
                          MakeFrames(path, file, skin, /*rate_hz=*/50));
  return absl::OkStatus();
}

absl::Status SkinFileExample() {
  TACTUS_ASSIGN_OR_RETURN(SkinFile skin, ReadSkinFile("mine/skin.json"));
  skin.layout.rows;
  return absl::OkStatus();
}

void TrialExample(const Trial& trial) {
  std::vector<float> frame(trial.taxels.rows * trial.taxels.columns);
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, frame.data());
  }
}

absl::Status TrialFileExample(const std::string& path, const Trial& trial) {
  {
    TACTUS_ASSIGN_OR_RETURN(auto writer, TrialFileWriter::Create(path, {}));
    TACTUS_RETURN_IF_ERROR(writer.Append(trial));
    TACTUS_RETURN_IF_ERROR(writer.Close());
  }
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(Trial trial, reader.Read(i));
  }
  return absl::OkStatus();
}

absl::Status TrialRecordExample(const Trial& trial) {
  const std::string bytes = ToRecord(trial).SerializeAsString();
  v1::TrialRecord record;
  record.ParseFromString(bytes);
  TACTUS_ASSIGN_OR_RETURN(Trial same, FromRecord(record));
  return absl::OkStatus();
}

absl::Status TrialTableExample(const SkinFile& skin) {
  TACTUS_ASSIGN_OR_RETURN(
      const TrialTable table,
      TrialTable::Read("mine/trials.csv", "mine/skin.json", skin.fields));
  const std::string label = table.Text(0, "label");
  return absl::OkStatus();
}

absl::Status TrialLayoutExample(const Trial& trial) {
  TACTUS_ASSIGN_OR_RETURN(SkinLayout given, ReadLayoutFile("palm.json"));
  TACTUS_ASSIGN_OR_RETURN(SkinLayout skin, LayoutOfTrial(trial, &given));
  return absl::OkStatus();
}

}  // namespace tactus::examples
