#include "tools/console/import_program.h"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/draft_file.h"
#include "tools/console/child_program.h"

namespace tactus::internal::console {
namespace {

using client::Json;

constexpr char kTrials[] = "trials.h5";
// Where that lies, beside the files.
constexpr char kMade[] = "made";
constexpr char kRoots[] = "authorities.pem";
constexpr size_t kMostTextBytes = 1'000;
constexpr size_t kMostDatasetBytes = 64;

absl::StatusOr<Json> ObjectFrom(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_object()) return json;
  return InvalidConfig("body", "something else", "a JSON object in UTF-8");
}

absl::Status TakeText(const std::string& name, const Json& value,
                      std::string& text) {
  if (value.is_string()) {
    text = value.get<std::string>();
    const std::string fault = TextFault(text, kMostTextBytes);
    if (fault.empty()) return absl::OkStatus();
    return InvalidConfig(name, Quoted(text), fault);
  }
  return InvalidConfig(name, Quoted(client::JsonText(value)), "a text");
}

absl::Status UnknownField(const std::string& name) {
  return InvalidConfig("field", Quoted(name), "one that is known");
}

// "trainctl: a\n  more of a\ntrainctl: b\n" as ["a\n  more of a", "b"].
std::vector<std::string> Paragraphs(absl::string_view text) {
  constexpr absl::string_view kBegin = "trainctl: ";
  std::vector<std::string> paragraphs;
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    if (absl::ConsumePrefix(&line, kBegin) || paragraphs.empty()) {
      paragraphs.emplace_back(line);
    } else {
      absl::StrAppend(&paragraphs.back(), "\n", line);
    }
  }
  for (std::string& paragraph : paragraphs) {
    absl::StripTrailingAsciiWhitespace(&paragraph);
  }
  std::erase(paragraphs, "");
  return paragraphs;
}

std::string MebibytesText(int64_t bytes) {
  return absl::StrCat(bytes / (1024 * 1024), " MiB");
}

// Why a signal ended the program.
std::string SignalText(const ImportProgram& program, const ChildEnd& end) {
  const bool has_no_memory =
      end.signal == SIGKILL || absl::StrContains(end.err, "bad_alloc");
  if (end.took_too_long || end.signal == SIGXCPU) {
    return absl::StrCat(
        "takes longer than the ",
        program.patience / std::chrono::milliseconds(1'000),
        " s that the console gives an import; use trainctl import");
  }
  if (end.signal == SIGXFSZ) {
    return absl::StrCat("the trials take more than ",
                        MebibytesText(limits::kMaxImportTrialBytes),
                        "; import the files in parts");
  }
  if (has_no_memory) {
    return absl::StrCat("needs more memory than the ",
                        MebibytesText(program.memory_bytes),
                        " that the console gives an import; import the files "
                        "in parts, or use trainctl import");
  }
  const char* name = sigabbrev_np(end.signal);
  return absl::StrCat("a file cannot be read: trainctl was ended by SIG",
                      name == nullptr ? "?" : name);
}

absl::StatusOr<Json> AnswerOf(const ImportProgram& program,
                              const ChildEnd& end) {
  if (end.was_cancelled) return absl::CancelledError("the import was ended");
  std::vector<std::string> remarks;
  if (end.signal == 0) remarks = Paragraphs(end.err);
  if (end.status == 0) {
    Json result = Json::parse(end.out, nullptr, false);
    if (result.is_discarded()) {
      return InvalidResponse("what trainctl prints", "something else", "JSON");
    }
    return Json{{"accepted", true},
                {"remarks", std::move(remarks)},
                {"result", std::move(result)}};
  }
  std::string error = end.signal != 0
                          ? SignalText(program, end)
                          : absl::StrCat("trainctl ended with ", end.status);
  if (end.signal == 0 && !remarks.empty()) {
    error = std::move(remarks.back());
    remarks.pop_back();
  }
  return Json{{"accepted", false},
              {"remarks", std::move(remarks)},
              {"error", std::move(error)}};
}

absl::StatusOr<Json> Ask(const ImportProgram& program,
                         std::vector<std::string> arguments,
                         const std::string& folder, const std::string& input,
                         const std::atomic<bool>& cancelled) {
  // What it has done so far is of no use to who reads its words later.
  arguments.insert(arguments.begin(), "--quiet");
  TACTUS_ASSIGN_OR_RETURN(const ChildEnd end,
                          RunChild({.program = program.path,
                                    .arguments = std::move(arguments),
                                    .folder = folder,
                                    .input = input,
                                    .memory_bytes = program.memory_bytes,
                                    .file_bytes = limits::kMaxImportTrialBytes,
                                    .text_bytes = limits::kMaxImportTextBytes,
                                    .patience = program.patience},
                                   cancelled));
  return AnswerOf(program, end);
}

}  // namespace

absl::StatusOr<ReadOptions> ReadOptionsFrom(const std::string& json,
                                            const ImportFiles& files) {
  TACTUS_ASSIGN_OR_RETURN(const Json object, ObjectFrom(json));
  ReadOptions options;
  const std::pair<const char*, std::string*> texts[] = {
      {"source", &options.source}, {"skin", &options.skin},
      {"table", &options.table},   {"file_names", &options.file_names},
      {"label", &options.label},   {"condition", &options.condition}};
  for (const auto& field : object.items()) {
    const std::string& name = field.key();
    const auto* known = std::ranges::find_if(
        texts, [&](const auto& text) { return name == text.first; });
    if (known == std::end(texts)) return UnknownField(name);
    TACTUS_RETURN_IF_ERROR(TakeText(name, field.value(), *known->second));
  }
  for (const std::string* file :
       {&options.source, &options.skin, &options.table}) {
    if (file->empty() || files.Has(*file)) continue;
    return InvalidConfig("file", Quoted(*file), "one that was sent");
  }
  return options;
}

absl::StatusOr<SendOptions> SendOptionsFrom(const std::string& json) {
  TACTUS_ASSIGN_OR_RETURN(const Json object, ObjectFrom(json));
  SendOptions options;
  for (const auto& [name, value] : object.items()) {
    if (name == "dataset") {
      TACTUS_RETURN_IF_ERROR(TakeText(name, value, options.dataset));
    } else if (name == "replace_labels" && value.is_boolean()) {
      options.replaces_labels = value.get<bool>();
    } else {
      return UnknownField(name);
    }
  }
  const std::string& dataset = options.dataset;
  const bool is_name =
      !dataset.empty() && dataset.size() <= kMostDatasetBytes &&
      dataset.front() != '-' && std::ranges::all_of(dataset, [](char c) {
        return absl::ascii_islower(c) || absl::ascii_isdigit(c) || c == '-';
      });
  if (is_name) return options;
  return InvalidConfig("dataset", Quoted(dataset),
                       "1 to 64 of a-z, 0-9 and -, and no - first");
}

absl::StatusOr<Json> ReadTrials(const ImportProgram& program,
                                const ImportFiles& files,
                                const ReadOptions& options,
                                const std::atomic<bool>& cancelled) {
  // With drafts that a program has left which was ended.
  const std::string made = absl::StrCat(files.folder(), "/", kMade);
  std::error_code error;
  std::filesystem::remove_all(made, error);
  std::filesystem::create_directory(made, error);
  if (error) return IoError("folder of the import", error.message());
  std::vector<std::string> arguments = {
      "import", options.source.empty() ? "." : options.source,
      absl::StrCat("--out=../", kMade, "/", kTrials), "--json"};
  const std::pair<const char*, const std::string*> flags[] = {
      {"--skin=", &options.skin},
      {"--table=", &options.table},
      {"--file-names=", &options.file_names},
      {"--label=", &options.label},
      {"--condition=", &options.condition}};
  for (const auto& [flag, value] : flags) {
    if (!value->empty()) arguments.push_back(absl::StrCat(flag, *value));
  }
  return Ask(program, std::move(arguments), files.Source(), "", cancelled);
}

absl::StatusOr<Json> SendTrials(const ImportProgram& program,
                                const ImportFiles& files,
                                const SendOptions& options,
                                const ServerAddress& server,
                                const std::string& token,
                                const std::atomic<bool>& cancelled) {
  const std::string made = absl::StrCat(files.folder(), "/", kMade);
  std::vector<std::string> arguments = {
      "datasets",
      "upload",
      options.dataset,
      absl::StrCat("--data=", kTrials),
      absl::StrCat("--server=", server.address),
      "--json"};
  if (options.replaces_labels) arguments.emplace_back("--replace-labels");
  if (server.channel.tls_roots) {
    TACTUS_RETURN_IF_ERROR(WriteFileBytes(absl::StrCat(made, "/", kRoots),
                                          *server.channel.tls_roots));
    arguments.push_back(absl::StrCat("--tls-ca=", kRoots));
  }
  // Neither on the disk nor where other users could see it.
  if (!token.empty()) arguments.emplace_back("--token-file=/proc/self/fd/0");
  return Ask(program, std::move(arguments), made, token, cancelled);
}

}  // namespace tactus::internal::console
