// trainctl show: draws one contact of a trial file as a picture.
#include <algorithm>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/data/trial_layout.h"
#include "tools/figures/gnuplot.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/data/contact_picture.h"
#include "tools/trainctl/data/contact_trace.h"

namespace tactus::internal::client {
namespace {

struct ShowFlags {
  std::string data;
  std::string trial;
  std::string model;
  std::string layout;
  std::string out;
};

absl::StatusOr<Trial> FindTrial(const std::string& path,
                                const std::string& id) {
  constexpr size_t kNamed = 5;
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  std::string first_ids;
  for (size_t i = 0; i < reader.size(); ++i) {
    if (reader.id(i) == id) return reader.Read(i);
    if (i < kNamed)
      absl::StrAppend(&first_ids, i == 0 ? "" : ", ", reader.id(i));
  }
  // Not an id; perhaps the name of a recording.
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(Trial trial, reader.Read(i));
    if (trial.source == id) return trial;
  }
  return InvalidConfig(
      "--trial", id,
      absl::StrCat("one of the ", reader.size(), " trials of ", path, ": ",
                   first_ids, reader.size() > kNamed ? ", ..." : ""));
}

absl::Status RunShow(const ShowFlags& flags) {
  SkinLayout layout;
  if (!flags.layout.empty()) {
    TACTUS_ASSIGN_OR_RETURN(layout, ReadLayoutFile(flags.layout));
  }
  std::shared_ptr<const CompiledModel> model;
  if (!flags.model.empty()) {
    TACTUS_ASSIGN_OR_RETURN(model, LoadModel(flags.model));
  }
  TACTUS_ASSIGN_OR_RETURN(const Trial trial,
                          FindTrial(flags.data, flags.trial));
  TACTUS_ASSIGN_OR_RETURN(const ContactTrace trace,
                          TraceContact(trial, layout, model));
  return DrawToFile(ScriptOf(trace).text(), flags.out);
}

}  // namespace

void AddShow(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<ShowFlags>();
  CLI::App* command =
      &AddVerb(app, "show", "Draw one contact: skin, features, posteriors",
               "show mine.h5 --trial=000000 --out=contact.png");
  command->add_option("data", flags->data, "Trial file")->required();
  command
      ->add_option("--trial", flags->trial,
                   "Id of the trial, or name of its recording")
      ->required();
  command->add_option("--model", flags->model,
                      "Bundle whose posteriors are drawn");
  command->add_option("--layout", flags->layout,
                      "JSON file with the skin of trials that carry none");
  command->add_option("--out", flags->out, "PNG file to write")->required();
  command->callback([=] { select([=] { return RunShow(*flags); }); });
}

}  // namespace tactus::internal::client
