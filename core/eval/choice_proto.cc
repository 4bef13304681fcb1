#include "core/eval/choice_proto.h"

#include <algorithm>

#include "core/train/train_spec.h"

namespace tactus::internal {
namespace {

v1::Learner ToProto(Learner learner) {
  switch (learner) {
    case Learner::kRidge:
      return v1::LEARNER_RIDGE;
    case Learner::kNearest:
      return v1::LEARNER_NEAREST;
    case Learner::kTrees:
      return v1::LEARNER_TREES;
    case Learner::kHmms:
      break;
  }
  return v1::LEARNER_HMMS;
}

Learner FromProto(v1::Learner learner) {
  if (learner == v1::LEARNER_RIDGE) return Learner::kRidge;
  if (learner == v1::LEARNER_NEAREST) return Learner::kNearest;
  if (learner == v1::LEARNER_TREES) return Learner::kTrees;
  return Learner::kHmms;
}

}  // namespace

v1::PresetChoice ToProto(const PresetChoice& choice) {
  v1::PresetChoice proto;
  proto.set_preset(choice.name);
  proto.set_networks(choice.options.lstm.networks);
  for (const ChoiceCandidate& candidate : choice.candidates) {
    v1::PresetCandidate& added = *proto.add_candidates();
    added.set_preset(candidate.preset);
    added.set_networks(candidate.networks);
    added.set_learner(ToProto(candidate.learner));
    added.set_correct(candidate.right);
    added.set_unfit(candidate.unfit);
  }
  proto.set_contacts(choice.contacts);
  proto.set_folds(choice.folds);
  proto.set_by_condition(choice.by == FoldsBy::kConditions);
  proto.set_by_group(choice.by == FoldsBy::kGroups);
  proto.set_work(choice.work);
  proto.set_work_limit(choice.work_limit);
  proto.set_nearest_correct(choice.nearest_right);
  proto.set_chance(choice.chance);
  return proto;
}

PresetChoice FromProto(const v1::PresetChoice& proto) {
  PresetChoice choice;
  choice.name = proto.preset();
  choice.options.lstm.networks = static_cast<int>(proto.networks());
  for (const v1::PresetCandidate& candidate : proto.candidates()) {
    choice.candidates.push_back(
        {candidate.preset(), static_cast<int>(candidate.networks()),
         FromProto(candidate.learner()), static_cast<int>(candidate.correct()),
         candidate.unfit()});
  }
  const auto chosen = std::ranges::find_if(
      choice.candidates,
      [&](const auto& candidate) { return IsChosen(candidate, choice); });
  if (chosen != choice.candidates.end()) {
    choice.options.learner = chosen->learner;
  }
  choice.contacts = static_cast<int>(proto.contacts());
  choice.folds = static_cast<int>(proto.folds());
  if (proto.by_condition()) choice.by = FoldsBy::kConditions;
  if (proto.by_group()) choice.by = FoldsBy::kGroups;
  choice.work = static_cast<int>(proto.work());
  choice.work_limit = static_cast<int>(proto.work_limit());
  choice.nearest_right = static_cast<int>(proto.nearest_correct());
  choice.chance = proto.chance();
  return choice;
}

OptionsRequest RequestOf(const v1::TrainSpec& spec) {
  return {.preset = spec.preset(),
          .skip_unusable = spec.skip_unusable(),
          .networks_given = spec.has_networks(),
          .choice_work = spec.has_choice_work()
                             ? static_cast<int>(spec.choice_work())
                             : kDefaultChoiceWork,
          .options_of = [&spec](absl::string_view name) {
            return OptionsOf(spec, name);
          }};
}

}  // namespace tactus::internal
