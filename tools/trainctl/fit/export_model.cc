// trainctl bundle export: writes the models of a bundle for other programs.
#include <filesystem>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/files/draft_file.h"
#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "core/interchange/lstm/lstm_to_onnx.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {
namespace {

struct ExportModelFlags {
  std::string bundle;
  std::string format;
  std::string out;
  bool json = false;
};

using NamedBytes = std::vector<std::pair<std::string, std::string>>;

absl::StatusOr<NamedBytes> Export(const Model& model,
                                  const std::string& format) {
  if (format == "hmmlearn-json") {
    return NamedBytes{
        {"hmms.json", HmmsToJson(model, HmmJsonStyle::kHmmlearn)}};
  }
  if (format == "ghmm") {
    return NamedBytes{
        {"hmms-ghmm.json", HmmsToJson(model, HmmJsonStyle::kGhmm)}};
  }
  if (format == "hmmlearn-npz") {
    TACTUS_ASSIGN_OR_RETURN(std::string bytes, HmmsToNpz(model));
    return NamedBytes{{"hmms.npz", std::move(bytes)}};
  }
  if (format != "onnx") {
    return InvalidConfig("--format", format,
                         "onnx, hmmlearn-json, hmmlearn-npz or ghmm");
  }
  TACTUS_ASSIGN_OR_RETURN(std::string sequence,
                          LstmsToOnnx(model, OnnxGraph::kSequence));
  TACTUS_ASSIGN_OR_RETURN(std::string step,
                          LstmsToOnnx(model, OnnxGraph::kStep));
  return NamedBytes{{"lstm-sequence.onnx", std::move(sequence)},
                    {"lstm-step.onnx", std::move(step)}};
}

absl::Status RunExportModel(const ExportModelFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const auto model, LoadModel(flags.bundle));
  TACTUS_ASSIGN_OR_RETURN(const NamedBytes files,
                          Export(model->model(), flags.format));
  TACTUS_RETURN_IF_ERROR(MakeFolder(flags.out));
  Json written = Json::array();
  for (const auto& [name, bytes] : files) {
    const std::string path = std::filesystem::path(flags.out) / name;
    TACTUS_RETURN_IF_ERROR(WriteFileBytes(path, bytes));
    if (!flags.json) std::cout << path << ": " << bytes.size() << " bytes\n";
    written.push_back({{"path", path}, {"bytes", bytes.size()}});
  }
  if (flags.json) {
    std::cout << JsonText(Json{{"format", flags.format}, {"files", written}})
              << "\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddExportModel(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<ExportModelFlags>();
  CLI::App& group = CommandGroup(
      app, "bundle", "Models of a bundle as files of other programs",
      "export mine.tactus --format=onnx --out=exported");
  CLI::App* command = &AddVerb(
      group, "export", "Write the HMMs or LSTMs of a bundle for other programs",
      "export mine.tactus --format=onnx --out=exported");
  command->add_option("bundle", flags->bundle, "Bundle to read")->required();
  command
      ->add_option("--format", flags->format,
                   "onnx (LSTMs), hmmlearn-json, hmmlearn-npz or ghmm (HMMs)")
      ->required();
  command->add_option("--out", flags->out, "Folder to write to")->required();
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunExportModel(*flags); }); });
}

}  // namespace tactus::internal::client
