// What the built-in model costs on a contact frame, beside what it gets wrong,
// as it is served and with steps of its LSTMs left out; and other bundles.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/contacts/anytime.h"
#include "core/contacts/world_contacts.h"
#include "core/files/file_bytes.h"
#include "server/registry/default_bundle.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/timing.h"
#include "tools/figures/figure.h"
#include "tools/figures/pareto.h"

namespace tactus::internal::client {
namespace {

constexpr int kTimedServedContacts = 64;
constexpr int kServedRounds = 15;

struct ServedVariant {
  std::string family;
  std::string name;
  std::shared_ptr<const CompiledModel> model;
  ContactClassifier::Options options = {};
};

struct ServedPoint {
  double nanoseconds = 0;
  // Wrong answers about the class so far, as fractions: mean over the times
  // of kAnytimeSeconds, 1.2 s after onset, and at the end.
  double wrong = 0;
  double wrong_soon = 0;
  double wrong_at_end = 0;
  double log_loss = 0;
  // Fraction of the LSTMs' due steps that were left out.
  double saved = 0;
  bool front = false;
};

// Sums over contacts.
struct ServedCounts {
  int right = 0;
  int right_soon = 0;
  int right_at_end = 0;
  double loss = 0;
  uint64_t saved = 0;
};

constexpr int kSoon = 3;
static_assert(kAnytimeSeconds[kSoon] == 1.2);

ServedCounts CountServed(const ServedVariant& variant,
                         const LabelledContact& contact) {
  const auto& names = variant.model->model().class_names;
  ContactClassifier classifier(variant.model, variant.options);
  ServedCounts counts;
  WalkContact(contact, classifier, [&](int time) {
    const std::string label = LabelSoFar(contact, classifier.frames() - 1);
    const auto probability = classifier.probability();
    const auto best = std::ranges::max_element(probability);
    const bool right = names[best - probability.begin()] == label;
    counts.right += right;
    if (time == kSoon) counts.right_soon += right;
    if (time == kAnytimeCount - 1) counts.right_at_end += right;
    const auto at = std::ranges::find(names, label) - names.begin();
    counts.loss -= std::log(std::max(probability[at], 1e-12));
  });
  counts.saved = classifier.saved_steps();
  return counts;
}

uint64_t DueSteps(const StepIntervals& intervals, uint64_t frames) {
  StepClock clock(intervals);
  uint64_t steps = 0;
  for (uint64_t t = 1; t <= frames; ++t) steps += clock.Tick(t);
  return steps;
}

ServedPoint MeasureAnswers(const ServedVariant& variant,
                           const std::vector<LabelledContact>& contacts) {
  std::vector<ServedCounts> counts(contacts.size());
  RunOnThreads(static_cast<int>(contacts.size()),
               [&](int i) { counts[i] = CountServed(variant, contacts[i]); });
  ServedPoint point;
  const auto n = static_cast<double>(contacts.size());
  double due = 0;
  for (size_t i = 0; i < contacts.size(); ++i) {
    point.wrong += 1 - counts[i].right / double{kAnytimeCount};
    point.wrong_soon += 1 - counts[i].right_soon;
    point.wrong_at_end += 1 - counts[i].right_at_end;
    point.log_loss += counts[i].loss / kAnytimeCount;
    point.saved += static_cast<double>(counts[i].saved);
    due += static_cast<double>(DueSteps(
        variant.model->model().inputs.lstm_steps, contacts[i].frames.size()));
  }
  point.wrong /= n;
  point.wrong_soon /= n;
  point.wrong_at_end /= n;
  point.log_loss /= n;
  point.saved /= due;
  return point;
}

// Steps the variants in turns through whole contacts; ns a frame, medians.
std::vector<double> TimeServed(const std::vector<ServedVariant>& variants,
                               const std::vector<LabelledContact>& contacts,
                               int rounds) {
  const int sample = std::min<int>(kTimedServedContacts, std::ssize(contacts));
  std::vector<ContactClassifier> classifiers;
  for (const ServedVariant& variant : variants) {
    classifiers.emplace_back(variant.model, variant.options);
  }
  int64_t frames = 0;
  for (int c = 0; c < sample; ++c) frames += std::ssize(contacts[c].frames);
  std::vector<std::vector<double>> seconds(variants.size());
  for (int round = 0; round <= rounds; ++round) {
    for (size_t v = 0; v < variants.size(); ++v) {
      const double start = ThreadSeconds();
      for (int c = 0; c < sample; ++c) {
        classifiers[v].Reset();
        for (const ContactFrame& frame : contacts[c].frames) {
          classifiers[v].StepOrHold(frame, 0);
        }
      }
      // The first round warms caches.
      if (round > 0) seconds[v].push_back(ThreadSeconds() - start);
    }
  }
  std::vector<double> nanoseconds;
  for (const std::vector<double>& each : seconds) {
    nanoseconds.push_back(Percentile(each, 0.5) / static_cast<double>(frames) *
                          1e9);
  }
  return nanoseconds;
}

absl::StatusOr<std::vector<ServedVariant>> ServedVariants() {
  TACTUS_ASSIGN_OR_RETURN(const auto served,
                          DecodeBundle(server::DefaultBundle()));
  std::vector<ServedVariant> variants;
  const auto add = [&](const char* family, std::string name,
                       const ContactClassifier::Options& options) {
    variants.push_back({family, std::move(name), served, options});
  };
  add("as served", "every step", {});
  add("HMMs alone", "HMMs alone", {.scorers = Scorers::kHmms});
  for (const double p : {0.9, 0.98, 0.995}) {
    for (const uint32_t steps : {2, 4}) {
      for (const uint32_t stride : {2, 4, 0}) {
        add("settled",
            absl::StrCat(p, " in ", steps, " steps, then ",
                         stride == 0 ? "none" : absl::StrCat("1 in ", stride)),
            {.savings = {.settled_probability = p,
                         .settled_steps = steps,
                         .settled_stride = stride}});
      }
    }
  }
  for (const double change : {0.02, 0.05, 0.1, 0.2, 0.4}) {
    for (const uint32_t most : {1, 3}) {
      add("unchanged",
          absl::StrCat("inputs within ", change, ", at most ", most),
          {.savings = {.unchanged_input = change, .most_unchanged = most}});
    }
  }
  for (const double p : {0.9, 0.98}) {
    for (const double change : {0.1, 0.2}) {
      add("both", absl::StrCat(p, " in 2 steps 1 in 2, within ", change),
          {.savings = {.settled_probability = p,
                       .settled_steps = 2,
                       .settled_stride = 2,
                       .unchanged_input = change,
                       .most_unchanged = 3}});
    }
  }
  for (const double p : {0.8, 0.9, 0.98}) {
    add("HMMs first", absl::StrCat("HMMs if at ", p),
        {.savings = {.sure_hmm_probability = p}});
  }
  for (const StepIntervals steps :
       {StepIntervals{5, 20}, StepIntervals{5, 40}, StepIntervals{10, 20},
        StepIntervals{10, 40}}) {
    Model model = served->model();
    if (steps == model.inputs.lstm_steps) continue;
    model.inputs.lstm_steps = steps;
    TACTUS_ASSIGN_OR_RETURN(auto compiled,
                            CompiledModel::Create(std::move(model)));
    variants.push_back({"other intervals",
                        absl::StrCat(steps.min, " to ", steps.max, " frames"),
                        std::move(compiled)});
  }
  return variants;
}

class ServedBenchmark : public Benchmark {
 public:
  const char* name() const override { return "served"; }
  const char* description() const override {
    return "The built-in model's run time against its errors on the random "
           "world";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--data", data_, "Recipe of the contacts");
    command.add_option("--bundle", bundles_,
                       "NAME=FILE: another bundle to compare with; repeatable");
    command.add_option("--table", table_, "Write a Markdown table");
    command.add_option("--figure", figure_, "Write the picture as PNG");
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(auto variants, ServedVariants());
    TACTUS_RETURN_IF_ERROR(AddBundles(variants));
    TACTUS_ASSIGN_OR_RETURN(WorldRecipe recipe, ParseWorldRecipe(data_));
    if (quick) recipe.contacts = 40;
    TACTUS_ASSIGN_OR_RETURN(const WorldContacts world,
                            MakeWorldContacts(recipe, RunOnThreads));
    const std::vector<double> nanoseconds =
        TimeServed(variants, world.contacts, quick ? 2 : kServedRounds);
    std::vector<ServedPoint> points;
    std::vector<ScatterPoint> scatter;
    for (size_t v = 0; v < variants.size(); ++v) {
      points.push_back(MeasureAnswers(variants[v], world.contacts));
      points.back().nanoseconds = nanoseconds[v];
      scatter.push_back({nanoseconds[v], points.back().wrong});
    }
    for (const int i : ParetoFront(scatter, Better::kLow, Better::kLow)) {
      points[i].front = true;
    }
    if (!table_.empty()) {
      TACTUS_RETURN_IF_ERROR(WriteTable(variants, points));
    }
    if (!figure_.empty()) TACTUS_RETURN_IF_ERROR(Draw(variants, points));
    std::vector<BenchRow> rows;
    for (size_t v = 0; v < variants.size(); ++v) {
      rows.push_back({.name = absl::StrCat("served/", variants[v].family, "/",
                                           variants[v].name),
                      .unit = "ns",
                      .ours = points[v].nanoseconds,
                      .accuracy = 1 - points[v].wrong});
    }
    return rows;
  }

 private:
  absl::Status AddBundles(std::vector<ServedVariant>& variants) const {
    for (const std::string& bundle : bundles_) {
      const std::pair<std::string, std::string> named =
          absl::StrSplit(bundle, absl::MaxSplits('=', 1));
      TACTUS_ASSIGN_OR_RETURN(
          const std::string bytes,
          ReadFileBytes(named.second, limits::kMaxBundleBytes));
      TACTUS_ASSIGN_OR_RETURN(auto model, DecodeBundle(bytes));
      variants.push_back({"other bundles", named.first, std::move(model)});
    }
    return absl::OkStatus();
  }

  absl::Status WriteTable(const std::vector<ServedVariant>& variants,
                          const std::vector<ServedPoint>& points) const {
    std::ofstream file(table_);
    file
        << "| | variant | ns | of every step | LSTM steps left out, % | wrong, "
           "% | wrong after 1.2 s, % | wrong at the end, % | log loss | front "
           "|\n|---|---|---|---|---|---|---|---|---|---|\n";
    for (size_t v = 0; v < variants.size(); ++v) {
      const ServedPoint& p = points[v];
      file << absl::StrFormat(
          "| %s | %s | %.0f | %.2f | %.0f | %.2f | %.2f | %.2f | %.4f | %s |\n",
          variants[v].family, variants[v].name, p.nanoseconds,
          p.nanoseconds / points[0].nanoseconds, 100 * p.saved, 100 * p.wrong,
          100 * p.wrong_soon, 100 * p.wrong_at_end, p.log_loss,
          p.front ? "yes" : "");
    }
    if (!file.flush()) return IoError(table_, "cannot be written");
    return absl::OkStatus();
  }

  // The points that get their name: what is served, and those of the front that
  // lie apart from one with a name. Names of all points would cover each other.
  static std::vector<bool> Named(const std::vector<ServedPoint>& points) {
    constexpr double kApart = 1.08;
    const auto close = [](double a, double b) {
      return std::max(a, b) < kApart * std::min(a, b);
    };
    std::vector<bool> named(points.size());
    for (size_t v = 0; v < points.size(); ++v) {
      named[v] = v == 0 || points[v].front;
      for (size_t u = 0; u < v && v > 0; ++u) {
        if (named[u] && close(points[u].nanoseconds, points[v].nanoseconds) &&
            close(points[u].wrong, points[v].wrong)) {
          named[v] = false;
        }
      }
    }
    return named;
  }

  absl::Status Draw(const std::vector<ServedVariant>& variants,
                    const std::vector<ServedPoint>& points) const {
    ScatterPlot plot;
    plot.title = "What an answer costs, and how often it is wrong";
    plot.pareto_front = true;
    plot.better_y = Better::kLow;
    plot.x = {.title = "time per contact frame (ns)", .scale = AxisScale::kLog};
    plot.y = {.title = "wrong, mean of six times (%)",
              .scale = AxisScale::kLog};
    const std::vector<bool> named = Named(points);
    for (size_t v = 0; v < variants.size(); ++v) {
      auto series = std::ranges::find(plot.series, variants[v].family,
                                      &ScatterSeries::name);
      if (series == plot.series.end()) {
        plot.series.push_back({.name = variants[v].family});
        series = plot.series.end() - 1;
      }
      series->points.push_back({points[v].nanoseconds, 100 * points[v].wrong,
                                named[v] ? variants[v].name : ""});
    }
    return DrawFigure(plot, figure_);
  }

  std::string data_ = "world:skin=good,contacts=4000,seed=1001";
  std::vector<std::string> bundles_;
  std::string table_;
  std::string figure_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeServedBenchmark() {
  return std::make_unique<ServedBenchmark>();
}

}  // namespace tactus::internal::client
