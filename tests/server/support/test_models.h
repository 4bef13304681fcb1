// File: test_models.h
//
// A ModelSource for tests: one small model under the name "default", and one
// trained on another skin under "models/vitac".
#pragma once

#include <string>

#include "core/base/errors.h"
#include "server/session/model_source.h"
#include "tests/support/small_model.h"

namespace tactus::internal::testing {

class TestModels : public server::ModelSource {
 public:
  TestModels() {
    Model model = SmallModel();
    default_ = *CompiledModel::Create(model);
    model.layout = *LayoutPreset("vitac-12x32");
    vitac_ = *CompiledModel::Create(model);
  }

  absl::StatusOr<server::PinnedModel> Find(absl::string_view name,
                                           absl::string_view) const override {
    if (name.empty() || name == "default") {
      return server::PinnedModel{default_, "models/default/versions/1",
                                 std::string(64, 'a')};
    }
    if (name == "models/vitac") {
      return server::PinnedModel{vitac_, "models/vitac/versions/1",
                                 std::string(64, 'b')};
    }
    return ModelNotFound(name);
  }

  std::vector<server::PinnedModel> Newest() const override {
    return {*Find("default", ""), *Find("models/vitac", "")};
  }

  const std::shared_ptr<const CompiledModel>& model() const { return default_; }

 private:
  std::shared_ptr<const CompiledModel> default_;
  std::shared_ptr<const CompiledModel> vitac_;
};

}  // namespace tactus::internal::testing
