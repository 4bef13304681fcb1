#include "core/bundle/learner_proto.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

template <class From, class To>
void Copy(const From& from, To* to) {
  to->Assign(from.begin(), from.end());
}

template <class Message>
void ViewsToProto(const FrameViews& views, Message* out) {
  out->set_rows(views.rows);
  out->set_columns(views.columns);
  out->set_block(views.block);
  out->mutable_scale()->Add(views.scale.begin(), views.scale.end());
  out->set_planes(views.planes);
  Copy(views.auxiliary_scale, out->mutable_auxiliary_scale());
}

void ToProto(const Ridge& ridge, v1::Ridge* out) {
  const HistorySpec& history = ridge.history;
  ViewsToProto(history, out);
  out->mutable_mixed_channel()->Add(history.mixed_channel.begin(),
                                    history.mixed_channel.end());
  Copy(history.mixed_weight, out->mutable_mixed_weight());
  Copy(history.threshold, out->mutable_threshold());
  Copy(ridge.offset, out->mutable_offset());
  Copy(ridge.gain, out->mutable_gain());
  Copy(ridge.weight, out->mutable_weight());
  Copy(ridge.bias, out->mutable_bias());
}

void ToProto(const Trees& trees, v1::Trees* out) {
  ViewsToProto(trees.history, out);
  out->set_classes(trees.classes);
  out->mutable_number()->Add(trees.number.begin(), trees.number.end());
  Copy(trees.threshold, out->mutable_threshold());
  out->mutable_child()->Add(trees.child.begin(), trees.child.end());
  out->mutable_root()->Add(trees.root.begin(), trees.root.end());
}

void ToProto(const Nearest& nearest, v1::Nearest* out) {
  ViewsToProto(nearest.views, out);
  out->set_view(nearest.view);
  Copy(nearest.gain, out->mutable_gain());
  Copy(nearest.sample, out->mutable_sample());
  out->mutable_label()->Add(nearest.label.begin(), nearest.label.end());
  out->set_classes(nearest.classes);
}

// The views of a message with rows, columns, block and scales.
template <class Message>
absl::StatusOr<FrameViews> ViewsFromProto(const Message& in) {
  constexpr uint32_t kMost = limits::kMaxTaxels;
  if (in.rows() > kMost || in.columns() > kMost || in.block() > kMost ||
      in.planes() > kMost || in.scale_size() != kFrameViews) {
    return InvalidModel(
        "rows, columns, block, planes and scales of the views",
        absl::StrCat(in.rows(), ", ", in.columns(), ", ", in.block(), ", ",
                     in.planes(), " and ", in.scale_size()),
        absl::StrCat("at most ", kMost, ", and ", kFrameViews, " scales"));
  }
  FrameViews views;
  views.rows = static_cast<int>(in.rows());
  views.columns = static_cast<int>(in.columns());
  views.block = static_cast<int>(in.block());
  std::ranges::copy(in.scale(), views.scale.begin());
  views.planes = static_cast<int>(in.planes());
  views.auxiliary_scale.assign(in.auxiliary_scale().begin(),
                               in.auxiliary_scale().end());
  return views;
}

absl::StatusOr<Trees> FromProto(const v1::Trees& in) {
  Trees trees;
  TACTUS_ASSIGN_OR_RETURN(static_cast<FrameViews&>(trees.history),
                          ViewsFromProto(in));
  if (in.classes() > uint32_t{limits::kMaxClasses}) {
    return InvalidModel("classes of the trees", in.classes(),
                        absl::StrCat("at most ", limits::kMaxClasses));
  }
  trees.classes = static_cast<int>(in.classes());
  trees.number.assign(in.number().begin(), in.number().end());
  trees.threshold.assign(in.threshold().begin(), in.threshold().end());
  trees.child.assign(in.child().begin(), in.child().end());
  trees.root.assign(in.root().begin(), in.root().end());
  return trees;
}

absl::StatusOr<Nearest> FromProto(const v1::Nearest& in) {
  Nearest nearest;
  TACTUS_ASSIGN_OR_RETURN(nearest.views, ViewsFromProto(in));
  constexpr uint32_t kMostClasses = limits::kMaxClasses;
  if (in.view() >= uint32_t{kFrameViews} || in.classes() > kMostClasses) {
    return InvalidModel(
        "view and classes of the nearest neighbours",
        absl::StrCat(in.view(), " and ", in.classes()),
        absl::StrCat("below ", kFrameViews, " and at most ", kMostClasses));
  }
  nearest.view = static_cast<int>(in.view());
  nearest.classes = static_cast<int>(in.classes());
  nearest.gain.assign(in.gain().begin(), in.gain().end());
  nearest.sample.assign(in.sample().begin(), in.sample().end());
  nearest.label.assign(in.label().begin(), in.label().end());
  return nearest;
}

absl::StatusOr<Ridge> FromProto(const v1::Ridge& in) {
  Ridge ridge;
  HistorySpec& history = ridge.history;
  TACTUS_ASSIGN_OR_RETURN(static_cast<FrameViews&>(history),
                          ViewsFromProto(in));
  for (const uint32_t channel : in.mixed_channel()) {
    // Larger ones would wrap around.
    if (channel > kMaxHistoryCells) {
      return InvalidModel("mixed channel of the history", channel,
                          absl::StrCat("at most ", kMaxHistoryCells));
    }
    history.mixed_channel.push_back(static_cast<uint16_t>(channel));
  }
  const auto copy = [](const auto& from, std::vector<float>& to) {
    to.assign(from.begin(), from.end());
  };
  copy(in.mixed_weight(), history.mixed_weight);
  copy(in.threshold(), history.threshold);
  copy(in.offset(), ridge.offset);
  copy(in.gain(), ridge.gain);
  copy(in.weight(), ridge.weight);
  copy(in.bias(), ridge.bias);
  return ridge;
}

SkinRange FromProto(const v1::SkinRange& in) {
  return {{in.least().begin(), in.least().end()},
          {in.most().begin(), in.most().end()}};
}

}  // namespace

void LearnersToProto(const Model& model, v1::ModelBundle& bundle) {
  if (model.ridge) ToProto(*model.ridge, bundle.mutable_ridge());
  if (model.nearest) ToProto(*model.nearest, bundle.mutable_nearest());
  if (model.trees) ToProto(*model.trees, bundle.mutable_trees());
  if (!model.skin_range) return;
  v1::SkinRange* range = bundle.mutable_skin_range();
  Copy(model.skin_range->least, range->mutable_least());
  Copy(model.skin_range->most, range->mutable_most());
}

absl::Status LearnersFromProto(const v1::ModelBundle& bundle, Model& model) {
  if (bundle.has_ridge()) {
    TACTUS_ASSIGN_OR_RETURN(model.ridge, FromProto(bundle.ridge()));
  }
  if (bundle.has_nearest()) {
    TACTUS_ASSIGN_OR_RETURN(model.nearest, FromProto(bundle.nearest()));
  }
  if (bundle.has_trees()) {
    TACTUS_ASSIGN_OR_RETURN(model.trees, FromProto(bundle.trees()));
  }
  if (bundle.has_skin_range()) {
    model.skin_range = FromProto(bundle.skin_range());
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
