#include "core/interchange/hmm/hmm_npz.h"

#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/interchange/hmm/hmm_fields.h"
#include "core/interchange/hmm/mixture_weights.h"
#include "core/interchange/model/inputs_json.h"
#include "core/interchange/model/model_file_error.h"

namespace tactus::internal {
namespace {

constexpr char kClassNames[] = "class_names";
constexpr char kInputs[] = "inputs";
constexpr char kScore[] = "score";

std::string Bytes(const NumberArray& array) {
  return NpyBytes(array.shape, std::span<const double>(array.values));
}

absl::StatusOr<const NpyArray*> Find(const NpzArrays& arrays,
                                     const std::string& name) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) {
    return InvalidModel(absl::StrCat("array ", name), "absent", "there");
  }
  return &found->second;
}

absl::StatusOr<NumberArray> FindNumbers(const NpzArrays& arrays,
                                        const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const NpyArray* array, Find(arrays, name));
  NumberArray out;
  out.shape = array->shape;
  out.values = array->f64;
  out.values.insert(out.values.end(), array->f32.begin(), array->f32.end());
  out.values.insert(out.values.end(), array->i64.begin(), array->i64.end());
  if (out.values.empty()) {
    return InvalidModel(absl::StrCat("array ", name),
                        "empty or of another type", "f8, f4 or i8 numbers");
  }
  return out;
}

absl::StatusOr<std::string> FindText(const NpzArrays& arrays,
                                     const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const NpyArray* array, Find(arrays, name));
  if (array->text.size() == 1) return array->text.front();
  return InvalidModel(absl::StrCat("array ", name), "no single text",
                      "a single text");
}

absl::StatusOr<GaussianHmm> ReadHmm(const NpzArrays& arrays,
                                    const std::string& prefix) {
  if (arrays.contains(prefix + kMixtureWeights)) {
    return InvalidModel(prefix + kMixtureWeights, "there",
                        "absent: mixtures of Gaussians in a state (GMMHMM) "
                        "are not supported");
  }
  HmmFields fields;
  TACTUS_ASSIGN_OR_RETURN(fields.covariance_type,
                          FindText(arrays, prefix + kCovarianceType));
  TACTUS_ASSIGN_OR_RETURN(fields.startprob,
                          FindNumbers(arrays, prefix + kStartProb));
  TACTUS_ASSIGN_OR_RETURN(fields.transmat,
                          FindNumbers(arrays, prefix + kTransMat));
  TACTUS_ASSIGN_OR_RETURN(fields.means, FindNumbers(arrays, prefix + kMeans));
  TACTUS_ASSIGN_OR_RETURN(fields.covars, FindNumbers(arrays, prefix + kCovars));
  return HmmOf(fields, prefix.empty() ? "HMM" : prefix);
}

absl::StatusOr<NamedMixture> ReadClass(const NpzArrays& arrays, size_t index,
                                       const std::string& name) {
  NamedMixture out;
  out.class_name = name;
  const std::string prefix = absl::StrCat(index, "/");
  for (int k = 0; k < limits::kMaxHmmsPerClass; ++k) {
    const std::string hmm_prefix = absl::StrCat(prefix, k, "/");
    if (k > 0 && !arrays.contains(hmm_prefix + kMeans)) break;
    TACTUS_ASSIGN_OR_RETURN(GaussianHmm hmm, ReadHmm(arrays, hmm_prefix));
    out.mixture.components.push_back(std::move(hmm));
  }
  std::vector<double> weights;
  if (arrays.contains(prefix + "weights")) {
    TACTUS_ASSIGN_OR_RETURN(NumberArray array,
                            FindNumbers(arrays, prefix + "weights"));
    weights = std::move(array.values);
  }
  TACTUS_RETURN_IF_ERROR(SetWeights(
      weights, absl::StrCat("class ", index, " (", name, ")"), &out.mixture));
  return out;
}

absl::Status ReadStatements(const NpzArrays& arrays, ForeignModel* out) {
  if (arrays.contains(kScore)) {
    TACTUS_ASSIGN_OR_RETURN(const std::string score, FindText(arrays, kScore));
    if (score != "forward" && score != "viterbi") {
      return InvalidModel(kScore, score, "forward or viterbi");
    }
    out->hmm_score = score == "viterbi" ? Score::kViterbi : Score::kForward;
  }
  if (!arrays.contains(kInputs)) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const std::string text, FindText(arrays, kInputs));
  const OrderedJson json = OrderedJson::parse(text, nullptr,
                                              /*allow_exceptions=*/false);
  if (!json.is_object()) {
    return InvalidModel(kInputs, json.type_name(), "a JSON object");
  }
  return ReadInputs(json, out);
}

absl::StatusOr<ForeignModel> Read(const NpzArrays& arrays) {
  ForeignModel out;
  if (!arrays.contains(kClassNames)) {
    TACTUS_ASSIGN_OR_RETURN(GaussianHmm hmm, ReadHmm(arrays, ""));
    out.hmms.push_back({"", {{0.0}, {std::move(hmm)}}});
    return out;
  }
  const std::vector<std::string>& names = arrays.at(kClassNames).text;
  if (names.empty() || names.size() > limits::kMaxClasses) {
    return InvalidModel(kClassNames, absl::StrCat(names.size(), " texts"),
                        absl::StrCat("1 to ", limits::kMaxClasses, " texts"));
  }
  for (size_t i = 0; i < names.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(NamedMixture named, ReadClass(arrays, i, names[i]));
    out.hmms.push_back(std::move(named));
  }
  TACTUS_RETURN_IF_ERROR(ReadStatements(arrays, &out));
  return out;
}

}  // namespace

absl::StatusOr<std::string> HmmsToNpz(const Model& model) {
  std::vector<std::pair<std::string, std::string>> arrays;
  arrays.emplace_back(kClassNames, NpyText(model.class_names));
  arrays.emplace_back(
      kScore,
      NpyText(model.hmm_score == Score::kViterbi ? "viterbi" : "forward"));
  OrderedJson inputs = OrderedJson::object();
  AddInputs(model.inputs.hmm, model.inputs.hmm_steps,
            model.inputs.sample_rate_hz, inputs);
  arrays.emplace_back(kInputs, NpyText(inputs.dump()));
  for (size_t i = 0; i < model.hmms.size(); ++i) {
    const std::vector<double> weights = WeightsOf(model.hmms[i]);
    arrays.emplace_back(absl::StrCat(i, "/weights"),
                        Bytes({{weights.size()}, weights}));
    for (size_t k = 0; k < weights.size(); ++k) {
      const std::string prefix = absl::StrCat(i, "/", k, "/");
      const HmmFields fields = FieldsOf(model.hmms[i].components[k]);
      arrays.emplace_back(prefix + kCovarianceType,
                          NpyText(fields.covariance_type));
      arrays.emplace_back(prefix + kStartProb, Bytes(fields.startprob));
      arrays.emplace_back(prefix + kTransMat, Bytes(fields.transmat));
      arrays.emplace_back(prefix + kMeans, Bytes(fields.means));
      arrays.emplace_back(prefix + kCovars, Bytes(fields.covars));
    }
  }
  auto bytes = NpzBytes(arrays);
  if (!bytes.ok()) return AsModelFileError(bytes.status());
  return bytes;
}

absl::StatusOr<ForeignModel> HmmsFromNpz(absl::string_view path,
                                         absl::string_view bytes) {
  const auto arrays = ParseNpz(path, bytes);
  if (!arrays.ok()) return AsModelFileError(arrays.status());
  auto model = Read(*arrays);
  if (!model.ok()) return Annotate(model.status(), path);
  return model;
}

}  // namespace tactus::internal
