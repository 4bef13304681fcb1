// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <deque>
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
#include "core/data/frames/frames_trial.h"
#include "core/data/recording/contact_cutter.h"
#include "core/data/recording/foxglove_contacts.h"
#include "core/data/recording/foxglove_image.h"
#include "core/data/recording/foxglove_schema.h"
#include "core/data/recording/message_schema.h"
#include "core/data/recording/recording.h"
#include "core/data/recording/recording_reader.h"
#include "core/data/recording/recording_writer.h"
#include "core/data/similar_names.h"
#include "core/data/touch.h"
#include "core/data/trial.h"
#include "core/data/trial_arrays.h"
#include "core/data/trial_csv.h"
#include "core/data/trial_fields.h"
#include "core/data/trial_file.h"
#include "core/data/trial_filter.h"
#include "core/data/trial_id.h"
#include "core/data/trial_layout.h"
#include "core/data/trial_loads.h"
#include "core/data/trial_npz.h"
#include "core/data/trial_pack.h"
#include "core/data/trial_record.h"
#include "core/data/trial_zarr.h"
#include "core/features/skin_tracker.h"
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
#include "core/files/mcap/compression.h"
#include "core/files/mcap/mcap_reader.h"
#include "core/files/mcap/mcap_records.h"
#include "core/files/mcap/mcap_writer.h"
#include "core/files/npy.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/files/number_cells.h"
#include "core/files/number_text.h"
#include "core/files/zarr.h"
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
#include "core/import/ros2/bag_files.h"
#include "core/import/ros2/bag_summary.h"
#include "core/import/ros2/cdr_reader.h"
#include "core/import/ros2/read_ros2_bag.h"
#include "core/import/ros2/ros2_bag.h"
#include "core/import/ros2/ros2_built_in.h"
#include "core/import/ros2/ros2_taxels.h"
#include "core/import/ros2/ros2_type.h"
#include "core/import/ros_bag.h"
#include "core/import/ros_message.h"
#include "core/import/skin_file.h"
#include "core/import/skin_folder_writer.h"
#include "core/import/trial_table.h"

namespace tactus::internal::examples {

absl::Status Use(Trial trial);

void Remark(const Trial& trial);

static void TouchExample(Trial& trial) {
#include "core/data/touch.h.inc"
}

static absl::Status TrialIdExample(
    Trial trial,
    absl::Status (*complain)(const char* field, const std::string& fault)) {
#include "core/data/trial_id.h.inc"
  return absl::OkStatus();
}

static void FrameFingerprintExample(const Trial& trial,
                                    std::set<std::string>& seen) {
#include "core/data/frame_fingerprint.h.inc"
}

static void FramesTrialExample(const std::deque<v1::FrameBatch>& frames,
                               v1::TaxelType type, double scale, double rate_hz,
                               const SkinLayout& layout) {
#include "core/data/frames/frames_trial.h.inc"
}

static absl::Status ContactCutterExample(const v1::StreamConfig& config,
                                         const SkinLayout& layout,
                                         const v1::FrameBatch& frame) {
#include "core/data/recording/contact_cutter.h.inc"
  return absl::OkStatus();
}

using v1::TAXEL_TYPE_UINT16;

static void FoxgloveContactsExample(const SkinLayout& layout,
                                    const v1::StreamStarted& started,
                                    const v1::Answer& answer) {
#include "core/data/recording/foxglove_contacts.h.inc"
}

static void FoxgloveImageExample(const SkinLayout& layout,
                                 const v1::FrameBatch& batch, int64_t time_ns,
                                 std::span<const float> taxels) {
#include "core/data/recording/foxglove_image.h.inc"
}

static void FoxgloveSchemaExample() {
#include "core/data/recording/foxglove_schema.h.inc"
}

static void MessageSchemaExample() {
#include "core/data/recording/message_schema.h.inc"
}

static void RecordingExample() {
#include "core/data/recording/recording.h.inc"
}

void Use(const v1::FrameBatch& frame);
void Use(std::span<const float> loads);

static absl::Status RecordingReaderExample() {
#include "core/data/recording/recording_reader.h.inc"
  return absl::OkStatus();
}

static absl::Status RecordingWriterExample(const v1::StreamConfig& config,
                                           const v1::FrameBatch& frame) {
#include "core/data/recording/recording_writer.h.inc"
  return absl::OkStatus();
}

static absl::Status ArrayFileExample() {
#include "core/files/array_file.h.inc"
  return absl::OkStatus();
}

static absl::Status NumberTextExample() {
#include "core/files/number_text.h.inc"
  return absl::OkStatus();
}

static void NumberCellsExample() {
#include "core/files/number_cells.h.inc"
}

static absl::Status Hdf5FiltersExample(hid_t properties,
                                       const Hdf5Complaint& complain) {
#include "core/files/hdf5_filters.h.inc"
  return absl::OkStatus();
}

static absl::Status Hdf5ArrayExample() {
#include "core/files/hdf5_array.h.inc"
  return absl::OkStatus();
}

static void ArrayOrderExample() {
#include "core/files/array_order.h.inc"
}

static void SimilarNamesExample(const std::vector<Trial>& trials) {
#include "core/data/similar_names.h.inc"
}

static absl::Status MistakesExample(
    const std::map<std::string, absl::Status>& read) {
#include "core/import/mistakes.h.inc"
  return absl::OkStatus();
}

static absl::Status FileNamesExample() {
#include "core/import/file_names.h.inc"
  return absl::OkStatus();
}

static absl::Status FrameColumnsExample(const ArrayFile& file,
                                        const SkinFile& skin) {
#include "core/import/frame_columns.h.inc"
  return absl::OkStatus();
}

static absl::Status ImportNotesExample(const ArrayFile& file,
                                       const RecordedFrames& frames) {
#include "core/import/import_notes.h.inc"
  return absl::OkStatus();
}

static void RisingColumnsExample(const std::vector<ArrayFile>& files,
                                 const std::vector<size_t>& columns) {
#include "core/import/rising_columns.h.inc"
}

static void CellAdviceExample() {
#include "core/files/cell_advice.h.inc"
}

static void RateCheckExample() {
#include "core/import/rate_check.h.inc"
}

void Print(const std::string& text);

static void OddRatesExample(const Trial& trial) {
#include "core/import/odd_rates.h.inc"
}

void Tell(double hz);

static void RateWatchExample(int64_t capture_time_ns) {
#include "core/base/rate_watch.h.inc"
}

static absl::Status RosBagExample() {
#include "core/import/ros_bag.h.inc"
  return absl::OkStatus();
}

void Save(const std::string& text);
void Use(const std::string& text, absl::string_view bytes);
absl::Status Broken(absl::string_view fault);

static absl::Status BagFilesExample() {
#include "core/import/ros2/bag_files.h.inc"
  (void)more;
  return absl::OkStatus();
}

static absl::Status BagSummaryExample() {
#include "core/import/ros2/bag_summary.h.inc"
  return absl::OkStatus();
}

static absl::Status CdrReaderExample(absl::string_view bytes) {
#include "core/import/ros2/cdr_reader.h.inc"
  (void)seconds;
  return absl::OkStatus();
}

static absl::Status ReadRos2BagExample() {
#include "core/import/ros2/read_ros2_bag.h.inc"
  return absl::OkStatus();
}

static absl::Status Ros2BagExample() {
#include "core/import/ros2/ros2_bag.h.inc"
  return absl::OkStatus();
}

static void BuiltInRos2TypeExample() {
#include "core/import/ros2/ros2_built_in.h.inc"
}

static absl::Status Ros2TaxelsExample(const Ros2Message& message) {
#include "core/import/ros2/ros2_taxels.h.inc"
  return absl::OkStatus();
}

static absl::Status Ros2TypeExample(absl::string_view bytes) {
#include "core/import/ros2/ros2_type.h.inc"
  return absl::OkStatus();
}

static absl::Status CompressionExample(const std::string& path,
                                       absl::string_view bytes, uint64_t size) {
#include "core/files/mcap/compression.h.inc"
  return absl::OkStatus();
}

static absl::Status RosMessageExample(absl::string_view text,
                                      absl::string_view bytes) {
#include "core/import/ros_message.h.inc"
  return absl::OkStatus();
}

static absl::Status CsvExample() {
#include "core/files/csv.h.inc"
  return absl::OkStatus();
}

static absl::Status DraftFileExample(const std::string& bytes) {
#include "core/files/draft_file.h.inc"
  return absl::OkStatus();
}

static absl::Status EventFramesExample(const std::string& path,
                                       const ArrayFile& file,
                                       const SkinFile& skin) {
#include "core/import/event_frames.h.inc"
  return absl::OkStatus();
}

static absl::Status FileBytesExample(const std::string& path) {
#include "core/files/file_bytes.h.inc"
  return absl::OkStatus();
}

static absl::Status Hdf5HandleExample(const char* path) {
#include "core/files/hdf5_handle.h.inc"
  return absl::OkStatus();
}

absl::Status ReadItAll(const std::string& path);

static absl::Status Hdf5ProbeExample(const std::string& path) {
#include "core/files/hdf5_probe.h.inc"
  return absl::OkStatus();
}

static absl::Status Hdf5ReadExample(const std::string& path, hid_t group) {
#include "core/files/hdf5_read.h.inc"
  return absl::OkStatus();
}

void Use(const McapMessage& message);

static absl::Status McapReaderExample() {
#include "core/files/mcap/mcap_reader.h.inc"
  return absl::OkStatus();
}

static void McapRecordsExample() {
#include "core/files/mcap/mcap_records.h.inc"
}

static absl::Status McapWriterExample(uint64_t time_ns) {
#include "core/files/mcap/mcap_writer.h.inc"
  return absl::OkStatus();
}

static void NpyWriteExample(const std::vector<double>& values) {
#include "core/files/npy_write.h.inc"
}

static absl::Status NpzExample(const std::vector<double>& time) {
#include "core/files/npz.h.inc"
  return absl::OkStatus();
}

static void TrialLoadsExample(const Trial& trial, const SkinLayout& skin,
                              SkinTracker& tracker) {
#include "core/data/trial_loads.h.inc"
}

static absl::Status TrialNpzExample(const Trial& trial) {
#include "core/data/trial_npz.h.inc"
  return absl::OkStatus();
}

static absl::Status ZarrExample(std::span<const double> time) {
#include "core/files/zarr.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialArraysExample(const Trial& trial) {
#include "core/data/trial_arrays.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialZarrExample(const Trial& trial) {
#include "core/data/trial_zarr.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialCsvExample(const Trial& trial) {
#include "core/data/trial_csv.h.inc"
  return absl::OkStatus();
}

static absl::Status IdleNoiseExample(const std::vector<Trial>& trials) {
#include "core/import/idle_noise.h.inc"
  return absl::OkStatus();
}

static void LightNoiseExample(const std::vector<Trial>& trials,
                              SkinLayout& layout) {
#include "core/import/light_noise.h.inc"
}

static absl::Status ImportRecordingExample() {
#include "core/import/import_recording.h.inc"
  return absl::OkStatus();
}

static absl::Status ImportSkinFolderExample() {
#include "core/import/import_skin_folder.h.inc"
  return absl::OkStatus();
}

static absl::Status SkinFolderWriterExample(const std::vector<Trial>& trials) {
#include "core/import/skin_folder_writer.h.inc"
  return absl::OkStatus();
}

static absl::Status ImportExample(const std::string& dir,
                                  const std::string& out) {
#include "core/import/import.h.inc"
  return absl::OkStatus();
}

static absl::Status NpyExample() {
#include "core/files/npy.h.inc"
  return absl::OkStatus();
}

static absl::Status RecordedFramesExample(const std::string& path,
                                          const ArrayFile& file,
                                          const SkinFile& skin) {
#include "core/import/recorded_frames.h.inc"
  return absl::OkStatus();
}

static absl::Status SkinFileExample() {
#include "core/import/skin_file.h.inc"
  return absl::OkStatus();
}

static void TrialExample(const Trial& trial) {
#include "core/data/trial.h.inc"
}

static absl::Status TrialFileExample(const std::string& path,
                                     const Trial& trial) {
#include "core/data/trial_file.h.inc"
  return absl::OkStatus();
}

absl::Status Use(const std::string& id);

std::string FieldOf(const Trial& trial, const std::string& field);

static absl::Status TrialFieldsExample(const TrialFilter& filter,
                                       const Trial& trial) {
#include "core/data/trial_fields.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialFilterExample(const Trial& trial) {
#include "core/data/trial_filter.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialPackExample(const Trial& trial) {
#include "core/data/trial_pack.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialRecordExample(const Trial& trial) {
#include "core/data/trial_record.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialTableExample(const SkinFile& skin) {
#include "core/import/trial_table.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialLayoutExample(const Trial& trial) {
#include "core/data/trial_layout.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::examples
