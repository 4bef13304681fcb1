#include "core/interchange/hmm/hmm_json.h"

#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/interchange/hmm/hmm_fields.h"
#include "core/interchange/hmm/mixture_weights.h"
#include "core/interchange/model/inputs_json.h"
#include "core/interchange/model/model_file_error.h"

namespace tactus::internal {
namespace {

constexpr char kFormat[] = "tactus-hmms";
constexpr int kVersion = 1;
constexpr size_t kMaxRank = 3;

// Nested lists of `array`, from dimension `axis` on, beginning at value `at`.
OrderedJson ToLists(const NumberArray& array, size_t axis = 0, size_t at = 0) {
  if (axis == array.shape.size()) return array.values[at];
  size_t stride = 1;
  for (size_t i = axis + 1; i < array.shape.size(); ++i) {
    stride *= array.shape[i];
  }
  OrderedJson list = OrderedJson::array();
  for (size_t i = 0; i < array.shape[axis]; ++i) {
    list.push_back(ToLists(array, axis + 1, at + i * stride));
  }
  return list;
}

// `text` with the NaN, Infinity and -Infinity that Python writes as texts,
// which JSON can hold.
std::string WithQuotedNonFinite(absl::string_view text) {
  std::string out;
  out.reserve(text.size());
  bool in_text = false;
  for (size_t i = 0; i < text.size();) {
    if (in_text && text[i] == '\\') {
      absl::StrAppend(&out, text.substr(i, 2));
      i += 2;
      continue;
    }
    if (text[i] == '"') in_text = !in_text;
    absl::string_view word;
    for (const absl::string_view name : {"NaN", "-Infinity", "Infinity"}) {
      if (!in_text && absl::StartsWith(text.substr(i), name)) word = name;
    }
    if (word.empty()) {
      out += text[i++];
    } else {
      absl::StrAppend(&out, "\"", word, "\"");
      i += word.size();
    }
  }
  return out;
}

// Appends the numbers of `json`, lists nested as deep as shape[axis..], to
// `values`. The error names the element, whose name so far is `name`.
absl::Status Flatten(const OrderedJson& json, const std::vector<size_t>& shape,
                     size_t axis, const std::string& name,
                     std::vector<double>* values) {
  if (axis == shape.size()) {
    if (!json.is_number()) {
      std::string got = json.type_name();
      if (json.is_string()) {
        const std::string& text = json.get_ref<const std::string&>();
        const bool non_finite =
            text == "NaN" || text == "Infinity" || text == "-Infinity";
        got = non_finite ? text : absl::StrCat("the text ", Quoted(text));
      }
      return InvalidModel(name, got, "a finite number");
    }
    values->push_back(json.get<double>());
    return absl::OkStatus();
  }
  if (!json.is_array() || json.size() != shape[axis]) {
    return InvalidModel(name,
                        json.is_array()
                            ? absl::StrCat("a list of ", json.size())
                            : std::string(json.type_name()),
                        absl::StrCat("a list of ", shape[axis]));
  }
  for (size_t i = 0; i < json.size(); ++i) {
    TACTUS_RETURN_IF_ERROR(Flatten(json[i], shape, axis + 1,
                                   absl::StrCat(name, "[", i, "]"), values));
  }
  return absl::OkStatus();
}

absl::StatusOr<NumberArray> FromLists(const OrderedJson& object,
                                      const char* name) {
  const auto found = object.find(name);
  if (found == object.end()) return InvalidModel(name, "absent", "there");
  NumberArray array;
  const OrderedJson* item = &*found;
  while (item->is_array() && !item->empty() && array.shape.size() < kMaxRank) {
    array.shape.push_back(item->size());
    item = &item->front();
  }
  if (array.shape.empty()) {
    return InvalidModel(name, found->type_name(), "nested lists of numbers");
  }
  TACTUS_RETURN_IF_ERROR(Flatten(*found, array.shape, 0, name, &array.values));
  return array;
}

OrderedJson HmmlearnJson(const GaussianHmm& hmm) {
  const HmmFields fields = FieldsOf(hmm);
  return {{kCovarianceType, fields.covariance_type},
          {kStartProb, ToLists(fields.startprob)},
          {kTransMat, ToLists(fields.transmat)},
          {kMeans, ToLists(fields.means)},
          {kCovars, ToLists(fields.covars)}};
}

OrderedJson GhmmJson(const GaussianHmm& hmm) {
  const HmmFields fields =
      FieldsOf(WithCovarianceType(hmm, CovarianceType::kFull));
  const size_t d = hmm.dimensions;
  OrderedJson emissions = OrderedJson::array();
  for (int s = 0; s < hmm.states; ++s) {
    const double* mean = &fields.means.values[s * d];
    const double* covariance = &fields.covars.values[s * d * d];
    emissions.push_back({std::vector<double>(mean, mean + d),
                         std::vector<double>(covariance, covariance + d * d)});
  }
  return {{"A", ToLists(fields.transmat)},
          {"B", std::move(emissions)},
          {"pi", hmm.start}};
}

absl::StatusOr<HmmFields> ReadHmmlearn(const OrderedJson& json) {
  HmmFields fields;
  // Fields of CategoricalHMM, MultinomialHMM and PoissonHMM.
  for (const char* other : {"emissionprob_", "lambdas_"}) {
    if (!json.contains(other)) continue;
    return InvalidModel(other, "there",
                        "absent: HMMs of symbols and counts are not "
                        "supported, GaussianHMM is");
  }
  const auto type = json.find(kCovarianceType);
  if (type == json.end() || !type->is_string()) {
    return InvalidModel(kCovarianceType,
                        type == json.end() ? "absent" : type->type_name(),
                        "full, diag, spherical or tied");
  }
  if (json.contains(kMixtureWeights)) {
    return InvalidModel(kMixtureWeights, "there",
                        "absent: mixtures of Gaussians in a state (GMMHMM) "
                        "are not supported");
  }
  fields.covariance_type = type->get<std::string>();
  TACTUS_ASSIGN_OR_RETURN(fields.startprob, FromLists(json, kStartProb));
  TACTUS_ASSIGN_OR_RETURN(fields.transmat, FromLists(json, kTransMat));
  TACTUS_ASSIGN_OR_RETURN(fields.means, FromLists(json, kMeans));
  TACTUS_ASSIGN_OR_RETURN(fields.covars, FromLists(json, kCovars));
  return fields;
}

absl::StatusOr<HmmFields> ReadGhmm(const OrderedJson& json) {
  HmmFields fields;
  fields.covariance_type = "full";
  TACTUS_ASSIGN_OR_RETURN(fields.startprob, FromLists(json, "pi"));
  TACTUS_ASSIGN_OR_RETURN(fields.transmat, FromLists(json, "A"));
  const absl::Status wrong = InvalidModel(
      "B", "of another form",
      "one list per state: [means of D numbers, covariance of D * D numbers]");
  const auto emissions = json.find("B");
  if (emissions == json.end() || !emissions->is_array() || emissions->empty()) {
    return wrong;
  }
  const OrderedJson& first = emissions->front();
  const size_t d = first.is_array() && !first.empty() && first[0].is_array()
                       ? first[0].size()
                       : 0;
  if (d == 0) return wrong;
  const size_t n = emissions->size();
  fields.means.shape = {n, d};
  fields.covars.shape = {n, d, d};
  for (size_t k = 0; k < n; ++k) {
    const OrderedJson& state = (*emissions)[k];
    if (!state.is_array() || state.size() != 2) return wrong;
    const std::string name = absl::StrCat("B[", k, "]");
    TACTUS_RETURN_IF_ERROR(
        Flatten(state[0], {d}, 0, name + "[0]", &fields.means.values));
    TACTUS_RETURN_IF_ERROR(
        Flatten(state[1], {d * d}, 0, name + "[1]", &fields.covars.values));
  }
  return fields;
}

absl::StatusOr<GaussianHmm> ReadHmm(const OrderedJson& json,
                                    const std::string& where) {
  if (!json.is_object()) {
    return InvalidModel(where, json.type_name(), "an object");
  }
  const bool ghmm = json.contains("A") || json.contains("pi");
  auto fields = ghmm ? ReadGhmm(json) : ReadHmmlearn(json);
  if (!fields.ok()) return Annotate(fields.status(), where);
  return HmmOf(*fields, where);
}

absl::StatusOr<NamedMixture> ReadClass(const OrderedJson& json, size_t index) {
  std::string where = absl::StrCat("class ", index);
  if (!json.is_object() || !json.contains("name") ||
      !json["name"].is_string() || !json.contains("hmms") ||
      !json["hmms"].is_array()) {
    return InvalidModel(where, json.type_name(),
                        "an object with a name and a list of hmms");
  }
  NamedMixture out;
  out.class_name = json["name"].get<std::string>();
  absl::StrAppend(&where, " (", out.class_name, ")");
  std::vector<double> weights;
  if (json.contains("weights")) {
    auto array = FromLists(json, "weights");
    if (!array.ok()) return Annotate(array.status(), where);
    weights = std::move(array->values);
  }
  const OrderedJson& hmms = json["hmms"];
  if (hmms.size() > limits::kMaxHmmsPerClass) {
    return InvalidModel(absl::StrCat(where, " HMMs"), hmms.size(),
                        absl::StrCat("at most ", limits::kMaxHmmsPerClass));
  }
  for (size_t k = 0; k < hmms.size(); ++k) {
    TACTUS_ASSIGN_OR_RETURN(GaussianHmm hmm,
                            ReadHmm(hmms[k], absl::StrCat(where, " hmm ", k)));
    out.mixture.components.push_back(std::move(hmm));
  }
  TACTUS_RETURN_IF_ERROR(SetWeights(weights, where, &out.mixture));
  return out;
}

absl::Status ReadScore(const OrderedJson& json, ForeignModel* out) {
  const auto score = json.find("score");
  if (score == json.end()) return absl::OkStatus();
  if (*score == "forward") {
    out->hmm_score = Score::kForward;
  } else if (*score == "viterbi") {
    out->hmm_score = Score::kViterbi;
  } else {
    return InvalidModel("score", score->type_name(), "forward or viterbi");
  }
  return absl::OkStatus();
}

absl::StatusOr<ForeignModel> Read(const OrderedJson& json) {
  ForeignModel out;
  if (!json.is_object()) {
    return InvalidModel("the file", json.type_name(), "a JSON object");
  }
  if (!json.contains("classes")) {
    // HMMs by the names of their classes.
    for (const auto& [name, item] : json.items()) {
      if (!item.is_object() || !(item.contains(kMeans) || item.contains("A"))) {
        continue;
      }
      return InvalidModel(
          "the file", absl::StrCat("HMMs by names, ", Quoted(name)),
          "one HMM, or {\"classes\": [{\"name\": \"HU\", \"hmms\": [...]}]}");
    }
    TACTUS_ASSIGN_OR_RETURN(GaussianHmm hmm, ReadHmm(json, "HMM"));
    out.hmms.push_back({"", {{0.0}, {std::move(hmm)}}});
    return out;
  }
  if (const auto version = json.find("version");
      version != json.end() && *version != kVersion) {
    return InvalidModel("version", version->type_name(),
                        absl::StrCat(kVersion));
  }
  const OrderedJson& classes = json["classes"];
  if (!classes.is_array() || classes.empty() ||
      classes.size() > limits::kMaxClasses) {
    return InvalidModel("classes", absl::StrCat(classes.size(), " entries"),
                        absl::StrCat("a list of 1 to ", limits::kMaxClasses));
  }
  for (size_t i = 0; i < classes.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(NamedMixture named, ReadClass(classes[i], i));
    out.hmms.push_back(std::move(named));
  }
  TACTUS_RETURN_IF_ERROR(ReadScore(json, &out));
  TACTUS_RETURN_IF_ERROR(ReadInputs(json, &out));
  return out;
}

}  // namespace

std::string HmmsToJson(const Model& model, HmmJsonStyle style) {
  OrderedJson json = {{"format", kFormat}, {"version", kVersion}};
  json["score"] = model.hmm_score == Score::kViterbi ? "viterbi" : "forward";
  AddInputs(model.inputs.hmm, model.inputs.hmm_steps,
            model.inputs.sample_rate_hz, json);
  OrderedJson& classes = json["classes"] = OrderedJson::array();
  for (size_t i = 0; i < model.hmms.size(); ++i) {
    OrderedJson hmms = OrderedJson::array();
    for (const GaussianHmm& hmm : model.hmms[i].components) {
      hmms.push_back(style == HmmJsonStyle::kGhmm ? GhmmJson(hmm)
                                                  : HmmlearnJson(hmm));
    }
    classes.push_back({{"name", model.class_names[i]},
                       {"weights", WeightsOf(model.hmms[i])},
                       {"hmms", std::move(hmms)}});
  }
  return json.dump(1, ' ', /*ensure_ascii=*/false,
                   OrderedJson::error_handler_t::replace) +
         "\n";
}

absl::StatusOr<ForeignModel> HmmsFromJson(absl::string_view path,
                                          absl::string_view text) {
  const OrderedJson json =
      OrderedJson::parse(WithQuotedNonFinite(text), nullptr,
                         /*allow_exceptions=*/false);
  if (json.is_discarded()) {
    return InvalidModelFile(path, "is not JSON; write it with json.dump");
  }
  auto model = Read(json);
  if (!model.ok()) return Annotate(model.status(), path);
  return model;
}

}  // namespace tactus::internal
