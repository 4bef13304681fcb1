// paper-hmms: the HMM rows of the paper's table of the simulation, made in
// other ways too. One robot condition is left out at a time.
//
//   paper-hmms --data=signals.h5
//
// Every HMM has 10 states and full covariances, begins as InitPaper says, and
// is scored by its best path. The table counts what fails:
//
// - A broken HMM is invalid after training: it holds a NaN, or a covariance is
//   not positive definite.
// - A contact is refused if libghmm finds no path for it in the HMM of its own
//   class. Its answer counts as wrong.
//
// Progress goes to stderr, a Markdown table to stdout.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/base/work.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/data/trial_file.h"
#include "core/eval/paper_tables.h"
#include "core/hmm/baum_welch.h"
#include "core/hmm/hmm_bank.h"
#include "core/hmm/init.h"
#include "tests/bench/ghmm_peer.h"

namespace tactus::internal {
namespace {

using client::GhmmPeer;
using client::MakeGhmmPeer;

// One way to make the HMMs.
struct Variant {
  const char* name;
  double covariance_floor = 1e-3;
  int max_iterations = 15;
  bool left_right = true;
  // libghmm trains and scores.
  bool libghmm = false;
  // False, as in the paper: a feature that models take alone is not scaled.
  bool scale_single = true;
};

constexpr Variant kVariants[] = {
    {.name = "as reproduced"},
    {.name = "floor 1e-4, 200 updates",
     .covariance_floor = 1e-4,
     .max_iterations = 200},
    {.name = "floor 1e-9, 200 updates",
     .covariance_floor = 1e-9,
     .max_iterations = 200},
    {.name = "any state follows any", .left_right = false},
    {.name = "libghmm, 15 updates", .libghmm = true},
    {.name = "libghmm, 200 updates", .max_iterations = 200, .libghmm = true},
    {.name = "the same, one feature not scaled",
     .max_iterations = 200,
     .libghmm = true,
     .scale_single = false},
};

using Observations = std::vector<double>;  // [frames x features] row-major

Observations Select(const LabelledContact& contact,
                    const std::vector<Feature>& features) {
  Observations out;
  for (size_t t = 0; t < contact.frames.size(); ++t) {
    for (const Feature feature : features) {
      out.push_back(contact.frames.features(t)[static_cast<int>(feature)]);
    }
  }
  return out;
}

std::vector<SequenceView> Views(const std::vector<Observations>& observations,
                                const std::vector<int>& indices,
                                int dimensions) {
  std::vector<SequenceView> views;
  for (const int i : indices) {
    views.push_back({observations[i].data(),
                     static_cast<int>(observations[i].size()) / dimensions,
                     dimensions});
  }
  return views;
}

// Gives every feature mean 0 and deviation 1 over the frames of `training`.
void Scale(const std::vector<int>& training, int dimensions,
           std::vector<Observations>& observations) {
  const FrameMoments moments =
      ComputeFrameMoments(Views(observations, training, dimensions));
  for (Observations& each : observations) {
    for (size_t k = 0; k < each.size(); ++k) {
      const size_t d = k % dimensions;
      each[k] = (each[k] - moments.mean[d]) / std::sqrt(moments.variance[d]);
    }
  }
}

// Training contacts and HMM of one class.
struct Category {
  std::string label;
  std::vector<SequenceView> contacts;
  GaussianHmm hmm;
  // Holds the HMM if libghmm trains it.
  std::unique_ptr<GhmmPeer> peer;
};

absl::Status Train(const Variant& variant, Category& category) {
  const InitOptions init = {.left_right = variant.left_right,
                            .covariance_floor = variant.covariance_floor};
  TACTUS_ASSIGN_OR_RETURN(category.hmm, InitPaper(category.contacts, init));
  if (variant.libghmm) {
    category.peer = MakeGhmmPeer(category.hmm);
    TACTUS_RETURN_IF_ERROR(
        category.peer->Train(category.contacts, variant.max_iterations));
    category.hmm = category.peer->model();
    return absl::OkStatus();
  }
  const BaumWelchOptions training = {
      .max_iterations = variant.max_iterations,
      .covariance_floor = variant.covariance_floor,
      .left_right = variant.left_right};
  return BaumWelch(category.contacts, training, category.hmm).status();
}

// Log-likelihood of the best path, [contacts x classes].
using Scores = std::vector<std::vector<double>>;

absl::StatusOr<Scores> ScoreHere(const std::vector<Category>& categories,
                                 const std::vector<SequenceView>& tests) {
  std::vector<HmmMixture> mixtures;
  for (const Category& category : categories) {
    mixtures.push_back({.log_weight = {0}, .components = {category.hmm}});
  }
  TACTUS_ASSIGN_OR_RETURN(const HmmBank bank, HmmBank::Create(mixtures));
  BankFilter filter(bank, Score::kViterbi);
  Scores scores;
  for (const SequenceView& test : tests) {
    filter.Reset();
    for (int t = 0; t < test.frames; ++t) filter.Step(test.frame(t));
    scores.emplace_back(categories.size());
    filter.LogLikelihood(scores.back());
  }
  return scores;
}

// A contact that an HMM of libghmm refuses scores kRefused there.
constexpr double kRefused = -std::numeric_limits<double>::infinity();

Scores ScoreWithLibghmm(const std::vector<Category>& categories,
                        const std::vector<SequenceView>& tests) {
  Scores scores(tests.size());
  for (const Category& category : categories) {
    for (size_t i = 0; i < tests.size(); ++i) {
      const SequenceView& test = tests[i];
      Observations copy(test.data, test.data + test.frames * test.dimensions);
      scores[i].push_back(category.peer->ViterbiScore(copy).value_or(kRefused));
    }
  }
  return scores;
}

struct Count {
  int right = 0;
  // Contacts without a path in the HMM of their own class.
  int refused = 0;
  int hmms = 0;
  // HMMs that are invalid after training.
  int broken = 0;
};

absl::StatusOr<Count> Test(const Variant& variant,
                           const std::vector<LabelledContact>& contacts,
                           const std::vector<Feature>& features,
                           const std::vector<int>& fold) {
  const int dimensions = static_cast<int>(features.size());
  std::vector<Observations> observations;
  for (const LabelledContact& contact : contacts) {
    observations.push_back(Select(contact, features));
  }
  const std::vector<int> training =
      Complement(fold, static_cast<int>(contacts.size()));
  if (dimensions > 1 || variant.scale_single) {
    Scale(training, dimensions, observations);
  }
  std::map<std::string, std::vector<int>> by_label;
  for (const int i : training) by_label[contacts[i].label].push_back(i);
  Count count;
  std::vector<Category> categories;
  for (const auto& [label, indices] : by_label) {
    Category& category = categories.emplace_back();
    category.label = label;
    category.contacts = Views(observations, indices, dimensions);
    TACTUS_RETURN_IF_ERROR(Train(variant, category));
    ++count.hmms;
    count.broken += !Validate(category.hmm).ok();
  }
  const auto tests = Views(observations, fold, dimensions);
  Scores scores;
  if (variant.libghmm) {
    scores = ScoreWithLibghmm(categories, tests);
  } else {
    TACTUS_ASSIGN_OR_RETURN(scores, ScoreHere(categories, tests));
  }
  for (size_t i = 0; i < fold.size(); ++i) {
    const auto best = std::ranges::max_element(scores[i]) - scores[i].begin();
    for (size_t c = 0; c < categories.size(); ++c) {
      if (categories[c].label != contacts[fold[i]].label) continue;
      const bool refused = scores[i][c] == kRefused;
      count.refused += refused;
      count.right += !refused && best == static_cast<ptrdiff_t>(c);
    }
  }
  return count;
}

absl::StatusOr<std::vector<LabelledContact>> Load(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  std::vector<LabelledContact> contacts;
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(trial));
    if (contact) contacts.push_back(*std::move(contact));
  }
  return contacts;
}

absl::StatusOr<Count> TestAll(const Variant& variant,
                              const std::vector<LabelledContact>& contacts,
                              const std::vector<Feature>& features,
                              const std::vector<std::vector<int>>& folds) {
  std::vector<absl::StatusOr<Count>> counts(folds.size());
  const auto test = [&](int i) {
    counts[i] = Test(variant, contacts, features, folds[i]);
  };
  const int total = static_cast<int>(folds.size());
  // libghmm keeps global state.
  variant.libghmm ? RunSerially(total, test) : RunOnThreads(total, test);
  Count sum;
  for (const absl::StatusOr<Count>& each : counts) {
    TACTUS_RETURN_IF_ERROR(each.status());
    sum.right += each->right;
    sum.refused += each->refused;
    sum.hmms += each->hmms;
    sum.broken += each->broken;
  }
  return sum;
}

absl::Status Run(const std::string& data) {
  TACTUS_ASSIGN_OR_RETURN(const auto contacts, Load(data));
  std::vector<const LabelledContact*> pointers;
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  TACTUS_ASSIGN_OR_RETURN(const auto folds,
                          MakeFolds(pointers, Protocol::kLeaveOneConditionOut));
  std::printf("| features | paper, %% |");
  for (const Variant& variant : kVariants) std::printf(" %s |", variant.name);
  std::printf("\n|---|---|");
  for (size_t v = 0; v < std::size(kVariants); ++v) std::printf("---|");
  std::printf("\n");
  for (const PaperRow& row : PaperTable(Experiment::kSimulation)) {
    if (row.algorithm != Algorithm::kHmm) continue;
    const std::vector<Feature> features = PaperFeatures(row.features);
    const std::string name(row.features);
    std::printf("| %s | %.2f |", name.c_str(), row.accuracy_percent);
    for (const Variant& variant : kVariants) {
      std::fprintf(stderr, "paper-hmms: %s, %s\n", name.c_str(), variant.name);
      TACTUS_ASSIGN_OR_RETURN(const Count count,
                              TestAll(variant, contacts, features, folds));
      std::printf(" %.2f", 100.0 * count.right / contacts.size());
      if (count.broken > 0) {
        std::printf(" (%d of %d HMMs broken; %d refused)", count.broken,
                    count.hmms, count.refused);
      } else if (count.refused > 0) {
        std::printf(" (%d refused)", count.refused);
      }
      std::printf(" |");
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return absl::OkStatus();
}

int Main(int argc, char** argv) {
  CLI::App app("HMMs of the paper's simulation, trained in several ways.",
               "paper-hmms");
  std::string data;
  app.add_option("--data", data, "Trial file with ideal signals")->required();
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = Run(data);
  if (status.ok()) return 0;
  std::fprintf(stderr, "paper-hmms: %s\n", status.ToString().c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::internal

int main(int argc, char** argv) { return tactus::internal::Main(argc, argv); }
