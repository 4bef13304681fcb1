#include "tools/trainctl/report/evaluate_pictures.h"

#include <algorithm>
#include <map>

#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/features/contact_time.h"
#include "tools/figures/figure.h"
#include "tools/figures/gnuplot.h"
#include "tools/trainctl/data/contact_picture.h"
#include "tools/trainctl/data/contact_trace.h"
#include "tools/trainctl/report/evaluate_figures.h"

namespace tactus::internal::client {
namespace {

constexpr char kPhase[] = "draw pictures";

}  // namespace

absl::Status CheckPictures() { return RunGnuplot("").status(); }

absl::StatusOr<EvaluationPictures> DrawEvaluation(
    const Evaluation& result,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress) {
  const Progress part = progress.Part(kPhase, 1);
  double longest = 0;
  for (const LabelledContact* contact : contacts) {
    longest = std::max(longest, ContactSeconds(contact->frames.size(),
                                               contact->sample_rate_hz));
  }
  EvaluationPictures pictures;
  if (contacts.empty()) return pictures;
  const NamedEvaluation named{std::string(AlgorithmName(result.algorithm)),
                              &result, longest};
  if (longest >= kAnytimeSeconds.front()) {
    TACTUS_ASSIGN_OR_RETURN(pictures.anytime,
                            FigureAsPng(AnytimePlot(named, std::nullopt)));
  }
  part.Add(0.1);
  TACTUS_ASSIGN_OR_RETURN(pictures.reliability,
                          FigureAsPng(ReliabilityPlot(named)));
  part.Add(0.1);
  if (std::ranges::any_of(result.decisions,
                          [](const auto& d) { return d.has_value(); })) {
    TACTUS_ASSIGN_OR_RETURN(pictures.decisions,
                            FigureAsPng(DecisionPlot(named)));
  }
  part.Add(0.1);
  return pictures;
}

absl::StatusOr<std::vector<std::string>> DrawTrials(
    const std::string& path, const Json& worst, const SkinLayout& given,
    const std::shared_ptr<const CompiledModel>& model,
    const Progress& progress) {
  const Progress part = progress.Part(kPhase, 1);
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  std::map<std::string, size_t> index_of;
  for (size_t i = 0; i < reader.size(); ++i) index_of[reader.id(i)] = i;
  // Only one thread may read the file.
  std::vector<GnuplotScript> scripts;
  for (const Json& trial : worst) {
    const std::string id = trial["trial"].get<std::string>();
    const auto found = index_of.find(id);
    if (found == index_of.end()) {
      return IoError(path, absl::StrCat("has changed: there is no trial ", id));
    }
    TACTUS_ASSIGN_OR_RETURN(const Trial read, reader.Read(found->second));
    TACTUS_ASSIGN_OR_RETURN(const ContactTrace trace,
                            TraceContact(read, given, model));
    scripts.push_back(ScriptOf(trace));
    part.Add(0.2 / static_cast<double>(worst.size()));
  }
  std::vector<absl::StatusOr<std::string>> drawn(scripts.size());
  RunOnThreads(static_cast<int>(scripts.size()), [&](int i) {
    drawn[i] = RunGnuplot(scripts[i].text());
    part.Add(0.5 / static_cast<double>(scripts.size()));
  });
  std::vector<std::string> pictures;
  for (absl::StatusOr<std::string>& png : drawn) {
    TACTUS_RETURN_IF_ERROR(png.status());
    pictures.push_back(*std::move(png));
  }
  return pictures;
}

}  // namespace tactus::internal::client
