#include "core/train/fit_all.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/ranks.h"
#include "core/base/status_macros.h"
#include "core/train/archive.h"
#include "core/train/run_all.h"

namespace tactus::internal {
namespace {

// Memory for the LSTMs' inputs at any time, and for the contacts and the inputs
// together. A fit takes up to 0.5 GB beside them. Contacts that exceed the
// second leave no room for inputs.
constexpr size_t kKeptInputBytes = size_t{1} << 30;
constexpr size_t kFitBytes = size_t{3} << 29;
// Fractions of a fit's time, for the progress.
constexpr double kInputsWeight = 0.03;
constexpr double kTrainingWeight = 0.94;

// The memory that the LSTMs' inputs may take beside the contacts.
size_t RoomForInputs(const std::vector<const LabelledContact*>& contacts) {
  size_t taken = 0;
  for (const LabelledContact* contact : contacts) {
    taken += contact->frames.bytes() +
             contact->object_motion.size() * sizeof(double);
  }
  return std::min(kKeptInputBytes, kFitBytes - std::min(kFitBytes, taken));
}

// Stands for all ranks.
constexpr int kTogether = -1;

// Which rank does each task of a model.
struct Share {
  ModelFit* fit;
  std::vector<int> owner = {};
  // The first rank that does some of them. It keeps the inputs.
  int first_rank = 0;

  std::vector<int> TasksOf(int rank) const {
    std::vector<int> tasks;
    for (size_t task = 0; task < owner.size(); ++task) {
      if (owner[task] == rank) tasks.push_back(static_cast<int>(task));
    }
    return tasks;
  }
  // A rank that has nothing of a model need not make its inputs.
  bool Needs(int rank) const {
    return !TasksOf(rank).empty() || !TasksOf(kTogether).empty();
  }
};

std::vector<Share> SharesOf(const std::vector<ModelFit*>& fits,
                            const Ranks& ranks) {
  std::vector<std::pair<size_t, int>> tasks;
  std::vector<double> weights;
  std::vector<Share> shares;
  for (ModelFit* fit : fits) {
    for (int task = 0; task < fit->tasks(); ++task) {
      if (ranks.size() > 1 && fit->IsShardedNetwork(task)) continue;
      tasks.emplace_back(shares.size(), task);
      weights.push_back(fit->Weight(task));
    }
    shares.push_back({fit, std::vector<int>(fit->tasks(), kTogether)});
  }
  const std::vector<int> owner = ShareOut(weights, ranks.size());
  for (size_t i = 0; i < tasks.size(); ++i) {
    shares[tasks[i].first].owner[tasks[i].second] = owner[i];
  }
  for (Share& share : shares) {
    while (!share.Needs(share.first_rank)) ++share.first_rank;
  }
  return shares;
}

// Gives the other ranks what this one has made, and takes what they have.
// `made`: how its work went.
absl::Status ExchangeFits(const absl::Status& made,
                          const std::vector<Share>& shares, Ranks& ranks) {
  if (ranks.size() == 1) return made;
  absl::StatusOr<std::string> given;
  if (!made.ok()) {
    given = made;
  } else {
    ByteWriter writer;
    for (const Share& share : shares) {
      if (share.first_rank == ranks.rank()) share.fit->GiveInputs(writer);
      for (const int task : share.TasksOf(ranks.rank())) {
        share.fit->GiveTask(task, writer);
      }
    }
    given = writer.Take();
  }
  TACTUS_ASSIGN_OR_RETURN(const auto all, ranks.Exchange(given));
  std::vector<ByteReader> readers(all.begin(), all.end());
  for (const Share& share : shares) {
    for (int rank = 0; rank < ranks.size(); ++rank) {
      if (rank == ranks.rank()) continue;
      if (share.first_rank == rank) share.fit->TakeInputs(readers[rank]);
      for (const int task : share.TasksOf(rank)) {
        share.fit->TakeTask(task, readers[rank]);
      }
    }
  }
  for (int rank = 0; rank < ranks.size(); ++rank) {
    if (rank == ranks.rank() || readers[rank].AtEnd()) continue;
    return CheckpointInvalid(absl::StrCat("what rank ", rank, " has made"),
                             "its values do not fill it");
  }
  return absl::OkStatus();
}

// Models that are fitted together because there is room for the LSTMs' inputs
// of all of them. A model whose inputs alone find no room makes them for each
// batch.
struct Wave {
  std::vector<const Share*> shares;
  size_t bytes = 0;
};

std::vector<Wave> MakeWaves(const std::vector<Share>& shares, int rank,
                            size_t room) {
  std::vector<Wave> waves;
  for (const Share& share : shares) {
    if (!share.Needs(rank)) continue;
    const size_t bytes = share.fit->InputBytes();
    // What makes inputs for each batch keeps none of them.
    const size_t kept = bytes <= room ? bytes : 0;
    if (waves.empty() || waves.back().bytes + kept > room) {
      waves.emplace_back();
    }
    waves.back().shares.push_back(&share);
    waves.back().bytes += kept;
  }
  return waves;
}

class AllFits {
 public:
  AllFits(const FitRun& run, size_t room, const ParallelFor& start,
          const ParallelFor& parallel, Progress inputs, Progress training)
      : run_(run),
        room_(room),
        start_(start),
        parallel_(parallel),
        inputs_(std::move(inputs)),
        training_(std::move(training)) {}

  absl::Status Fit(const std::vector<Share>& shares) {
    const ParallelFor* first = &start_;
    for (const Wave& wave : MakeWaves(shares, run_.ranks.rank(), room_)) {
      TACTUS_RETURN_IF_ERROR(FitWave(wave, *first));
      first = &parallel_;
    }
    return absl::OkStatus();
  }

 private:
  // Fits the models of a wave. Their tasks form one list, so that no thread
  // waits for the end of one model before the next begins. Whoever watches the
  // fit sees its first iterations before all inputs of all models are made: the
  // threads of `start` make the HMMs' inputs of the first model, and one of its
  // tasks of HMMs is done before the LSTMs' inputs.
  absl::Status FitWave(const Wave& wave, const ParallelFor& start) {
    const std::vector<const Share*>& shares = wave.shares;
    const Share& front = *shares.front();
    const int early = front.fit->QuickestTask();
    const int rank = run_.ranks.rank();
    const bool has_early = front.owner[early] == rank;
    TACTUS_RETURN_IF_ERROR(front.fit->FitHmmInputs(start));
    TACTUS_RETURN_IF_ERROR(RunAll(parallel_, shares.size(), [&](int s) {
      ModelFit* const fit = shares[s]->fit;
      if (s > 0) {
        TACTUS_RETURN_IF_ERROR(fit->FitHmmInputs(RunSerially));
      } else if (has_early) {
        TACTUS_RETURN_IF_ERROR(FitTask(fit, early, start));
      }
      TACTUS_RETURN_IF_ERROR(fit->FitLstmInputs(fit->InputBytes() <= room_,
                                                shares[s]->first_rank == rank));
      inputs_.Add(1);
      return absl::OkStatus();
    }));
    std::vector<std::pair<ModelFit*, int>> tasks;
    for (const Share* share : shares) {
      for (const int task : share->TasksOf(rank)) {
        if (share == &front && task == early) continue;
        tasks.emplace_back(share->fit, task);
      }
    }
    TACTUS_RETURN_IF_ERROR(RunAll(parallel_, tasks.size(), [&](int i) {
      return FitTask(tasks[i].first, tasks[i].second, RunSerially);
    }));
    for (const Share* share : shares) {
      for (const int task : share->TasksOf(kTogether)) {
        TACTUS_RETURN_IF_ERROR(FitTask(share->fit, task, RunSerially));
      }
      share->fit->DropInputs();
    }
    return absl::OkStatus();
  }

  absl::Status FitTask(ModelFit* fit, int task, const ParallelFor& lent) {
    return fit->FitTask(task, training_.Part("", fit->Weight(task)), lent);
  }

  const FitRun& run_;
  const size_t room_;
  const ParallelFor& start_;
  const ParallelFor& parallel_;
  const Progress inputs_;
  const Progress training_;
};

}  // namespace

absl::Status FitAll(const FitRun& run,
                    const std::vector<const LabelledContact*>& contacts,
                    const std::vector<ModelFit*>& fits,
                    const ParallelFor& start, const ParallelFor& parallel,
                    const Progress& progress) {
  double work = 0;
  for (const ModelFit* fit : fits) {
    for (int task = 0; task < fit->tasks(); ++task) work += fit->Weight(task);
  }
  const Progress inputs = progress.Part("fit inputs", kInputsWeight)
                              .Part("", 1 / static_cast<double>(fits.size()));
  const Progress training =
      progress.Part("train models", kTrainingWeight).Part("", 1 / work);
  const std::vector<Share> shares = SharesOf(fits, run.ranks);
  AllFits all(run, RoomForInputs(contacts), start, parallel, inputs, training);
  return ExchangeFits(all.Fit(shares), shares, run.ranks);
}

}  // namespace tactus::internal
