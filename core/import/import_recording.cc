#include "core/import/import_recording.h"

#include <filesystem>
#include <map>
#include <optional>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/recording/contact_cutter.h"
#include "core/data/recording/recording_reader.h"
#include "core/data/similar_names.h"
#include "core/files/csv.h"
#include "core/import/import_notes.h"
#include "core/import/skin_file.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kFields[] = {"label", "condition", "object",
                                         "material"};

// The rows of a table by the number of their contact.
struct ContactTable {
  std::optional<CsvTable> csv;
  std::map<size_t, size_t> rows;
};

absl::StatusOr<ContactTable> ReadContactTable(const std::string& path) {
  ContactTable table;
  if (path.empty()) return table;
  TACTUS_ASSIGN_OR_RETURN(table.csv, CsvTable::Read(path));
  TACTUS_ASSIGN_OR_RETURN(const size_t number, table.csv->Column("contact"));
  for (const absl::string_view column : table.csv->header()) {
    bool known = column == "contact";
    for (const absl::string_view field : kFields) known |= column == field;
    if (known) continue;
    return TrialFileInvalid(
        path,
        absl::StrCat("has the column ", Quoted(column),
                     "; it may have contact, ", absl::StrJoin(kFields, ", ")));
  }
  for (size_t row = 0; row < table.csv->rows(); ++row) {
    const absl::string_view text = table.csv->text(row, number);
    uint32_t contact = 0;
    if (!absl::SimpleAtoi(text, &contact) || contact == 0) {
      return table.csv->RowError(row,
                                 absl::StrCat("contact: is ", Quoted(text),
                                              "; it must be a number from 1"));
    }
    if (!table.rows.emplace(contact, row).second) {
      return table.csv->RowError(
          row, absl::StrCat("contact: ", contact, " is repeated"));
    }
  }
  return table;
}

class RecordingImport {
 public:
  RecordingImport(std::string path, const ImportOptions& options,
                  ContactTable table, std::optional<SkinFile> skin,
                  TrialSink sink)
      : path_(std::move(path)),
        options_(options),
        table_(std::move(table)),
        skin_(std::move(skin)),
        sink_(sink) {}

  absl::StatusOr<size_t> Run() {
    TACTUS_ASSIGN_OR_RETURN(const auto reader, RecordingReader::Open(path_));
    RecordingEvent event;
    while (true) {
      TACTUS_ASSIGN_OR_RETURN(const bool more, reader->Next(event));
      if (!more) break;
      if (const auto* config = std::get_if<v1::StreamConfig>(&event)) {
        TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout,
                                Layout(reader->layout()));
        cutter_.emplace(path_, *config, layout);
      } else if (const auto* trial = std::get_if<RecordedTrial>(&event)) {
        TACTUS_RETURN_IF_ERROR(EndTrial());
        trial_ = *trial;
      } else if (const auto* frame = std::get_if<v1::FrameBatch>(&event)) {
        ++frames_;
        TACTUS_ASSIGN_OR_RETURN(const bool ended, cutter_->Add(*frame));
        if (ended) TACTUS_RETURN_IF_ERROR(EndContact());
      } else if (std::holds_alternative<v1::EndOfTrial>(event)) {
        TACTUS_RETURN_IF_ERROR(EndTrial());
      } else if (std::holds_alternative<RawFrame>(event)) {
        ++raw_frames_;
      }
    }
    TACTUS_RETURN_IF_ERROR(EndTrial());
    RemarkRaw(RecordedTrial{reader->about()}.Text("device"));
    Remark(reader->CutOff());
    notes_.Tell(options_.remark);
    for (const auto& [contact, row] : table_.rows) {
      if (contact <= contacts_) continue;
      return table_.csv->RowError(
          row, absl::StrCat("contact: is ", contact, "; ", path_, " has ",
                            contacts_, " contacts"));
    }
    if (imported_ == 0) return TrialFileInvalid(path_, "holds no contact");
    return imported_;
  }

 private:
  // That of the recording, or that of the skin.json.
  absl::StatusOr<SkinLayout> Layout(const SkinLayout& recorded) const {
    if (!skin_) return recorded;
    const SkinLayout& layout = skin_->layout;
    if (skin_->thresholds_from_idle) {
      return TrialFileInvalid(options_.skin,
                              "thresholds: must be numbers for a recording");
    }
    if (layout.rows == recorded.rows && layout.columns == recorded.columns) {
      return layout;
    }
    return TrialFileInvalid(
        options_.skin,
        absl::StrCat("rows: the skin has ", layout.rows, " x ", layout.columns,
                     " taxels; the recording has ", recorded.rows, " x ",
                     recorded.columns));
  }

  void Remark(const std::string& text) const {
    if (!text.empty() && options_.remark) options_.remark(text);
  }

  // Which of its two kinds of frames were taken.
  void RemarkRaw(const std::string& device) const {
    if (raw_frames_ == 0) return;
    Remark(absl::StrCat(path_, ": the trials hold the loads of ", kFrameTopic,
                        "; ", raw_frames_, " frames of ", kRawTopic,
                        ", as the skin ", Quoted(device),
                        " sent them, stay in the recording"));
  }

  absl::Status EndTrial() {
    if (frames_ == 0) return absl::OkStatus();
    if (cutter_->EndTrial()) TACTUS_RETURN_IF_ERROR(EndContact());
    if (contacts_ == contacts_before_) {
      Remark(absl::StrCat("trial ", Printable(trial_.Text("id")), " (",
                          Printable(trial_.Text("label")),
                          "): no contact was felt in its ", frames_,
                          " frames"));
    }
    contacts_before_ = contacts_;
    frames_ = 0;
    return absl::OkStatus();
  }

  absl::Status EndContact() {
    ++contacts_;
    Trial trial = cutter_->Take();
    trial.id = absl::StrFormat("%06d", contacts_);
    trial.source = absl::StrCat(
        std::filesystem::path(path_).filename().string(), "#", contacts_);
    std::string* const values[] = {&trial.label, &trial.condition,
                                   &trial.object, &trial.material};
    const auto row = table_.rows.find(contacts_);
    const std::string what =
        absl::StrFormat("contact %d, %.2f s after the first frame", contacts_,
                        cutter_->onset_s());
    for (size_t i = 0; i < std::size(kFields); ++i) {
      *values[i] = trial_.Text(std::string(kFields[i]));
      if (row != table_.rows.end() && table_.csv->Has(kFields[i])) {
        *values[i] = std::string(
            table_.csv->text(row->second, *table_.csv->Column(kFields[i])));
      }
      *values[i] = TrimmedName(*values[i]);
      const std::string fault =
          TextFault(*values[i], limits::kMaxTrialTextBytes);
      if (!fault.empty()) {
        return TrialFileInvalid(
            path_, absl::StrCat(what, ": ", kFields[i], ": ", fault));
      }
    }
    if (trial.label.empty() && row != table_.rows.end()) {
      Remark(absl::StrCat(what, ": left out, because the table has no label"));
      return absl::OkStatus();
    }
    NameUnnamed(options_, trial);
    if (trial.label.empty()) {
      return TrialFileInvalid(
          path_, absl::StrCat(what,
                              ", has no label; name it in a table with "
                              "the columns contact and label"));
    }
    if (cutter_->missing() > 0) {
      Remark(absl::StrCat(what, ": ", cutter_->missing(),
                          " of its frames are missing"));
    }
    TACTUS_RETURN_IF_ERROR(Validate(trial, path_));
    ++imported_;
    notes_.AddNames(trial);
    return sink_(std::move(trial));
  }

  const std::string path_;
  const ImportOptions& options_;
  const ContactTable table_;
  const std::optional<SkinFile> skin_;
  const TrialSink sink_;
  std::optional<ContactCutter> cutter_;
  RecordedTrial trial_;
  ImportNotes notes_;
  // Contacts of the recording, and those before the trial.
  size_t contacts_ = 0;
  size_t contacts_before_ = 0;
  size_t imported_ = 0;
  size_t raw_frames_ = 0;
  // Frames of the trial.
  size_t frames_ = 0;
};

}  // namespace

absl::StatusOr<size_t> ImportRecording(const std::string& path,
                                       const ImportOptions& options,
                                       TrialSink sink) {
  TACTUS_ASSIGN_OR_RETURN(ContactTable table, ReadContactTable(options.table));
  std::optional<SkinFile> skin;
  if (!options.skin.empty()) {
    TACTUS_ASSIGN_OR_RETURN(skin, ReadSkinFile(options.skin));
  }
  return RecordingImport(path, options, std::move(table), std::move(skin), sink)
      .Run();
}

}  // namespace tactus::internal
