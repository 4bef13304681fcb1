// Changes fields of the default bundle, of a small model that is quicker to
// load, or of one with another learner than HMMs, repairs length and checksum,
// and loads the result as the server does. Whatever is accepted must classify:
// every number that a stream would send is finite, every distribution sums to
// 1.
#include <fuzzer/FuzzedDataProvider.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/bundle/bundle.h"
#include "core/bundle/model_proto.h"
#include "core/classify/contact_classifier.h"
#include "core/train/fit.h"
#include "google/protobuf/message.h"
#include "server/registry/default_bundle.h"
#include "tests/support/pattern_contacts.h"
#include "tests/support/sealed_bundle.h"
#include "tests/support/small_model.h"

namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

#define REQUIRE(condition) \
  if (!(condition)) __builtin_trap()

double Number(FuzzedDataProvider& data) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kNumbers[] = {
      0,         -0.0,       1,
      -1,        2,          1e-9,
      0.5,       1e6,        1e12,
      -1e12,     1e16,       1e30,
      -1e30,     1e300,      -1e300,
      1e308,     5e-324,     1e-300,
      kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()};
  return data.ConsumeBool() ? data.PickValueInArray(kNumbers)
                            : data.ConsumeFloatingPoint<double>();
}

uint64_t Whole(FuzzedDataProvider& data) {
  constexpr uint64_t kNumbers[] = {
      0,     1,      2,       3,          4,          15,        16,
      17,    64,     65,      255,        256,        257,       1'024,
      1'025, 10'000, 1 << 30, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
  return data.ConsumeBool() ? data.PickValueInArray(kNumbers)
                            : data.ConsumeIntegral<uint64_t>();
}

// Sets a singular field, or element `index` of a repeated one, which is added
// if `index` is its size.
void SetValue(FuzzedDataProvider& data, const FieldDescriptor* field,
              Message* message, int index) {
  const Reflection& r = *message->GetReflection();
  const bool repeated = field->is_repeated();
  const bool add = repeated && index == r.FieldSize(*message, field);
#define SET(Type, value)                               \
  if (add) {                                           \
    r.Add##Type(message, field, value);                \
  } else if (repeated) {                               \
    r.SetRepeated##Type(message, field, index, value); \
  } else {                                             \
    r.Set##Type(message, field, value);                \
  }                                                    \
  break
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      SET(Double, Number(data));
    case FieldDescriptor::CPPTYPE_FLOAT:
      SET(Float, static_cast<float>(Number(data)));
    case FieldDescriptor::CPPTYPE_INT32:
      SET(Int32, static_cast<int32_t>(Whole(data)));
    case FieldDescriptor::CPPTYPE_UINT32:
      SET(UInt32, static_cast<uint32_t>(Whole(data)));
    case FieldDescriptor::CPPTYPE_UINT64:
      SET(UInt64, Whole(data));
    case FieldDescriptor::CPPTYPE_BOOL:
      SET(Bool, data.ConsumeBool());
    case FieldDescriptor::CPPTYPE_ENUM:
      SET(EnumValue, static_cast<int>(data.ConsumeIntegralInRange(-1, 5)));
    case FieldDescriptor::CPPTYPE_STRING:
      SET(String, data.ConsumeRandomLengthString(300));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      if (add) r.AddMessage(message, field);
      break;
    default:
      break;
  }
#undef SET
}

// Adds a copy of the first element, or a new element.
void Grow(FuzzedDataProvider& data, const FieldDescriptor* field,
          Message* message) {
  const Reflection& r = *message->GetReflection();
  const int size = r.FieldSize(*message, field);
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && size > 0 &&
      data.ConsumeBool()) {
    // A copy first: adding may move the elements.
    Message* copy = r.GetRepeatedMessage(*message, field, 0).New();
    copy->CopyFrom(r.GetRepeatedMessage(*message, field, 0));
    r.AddAllocatedMessage(message, field, copy);
    return;
  }
  SetValue(data, field, message, size);
}

void Mutate(FuzzedDataProvider& data, Message* message) {
  const Reflection& r = *message->GetReflection();
  const auto& type = *message->GetDescriptor();
  const FieldDescriptor* field =
      type.field(data.ConsumeIntegralInRange(0, type.field_count() - 1));
  const bool nested = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
  if (!field->is_repeated()) {
    if (data.ConsumeProbability<double>() < 0.05) {
      r.ClearField(message, field);
    } else if (nested) {
      Mutate(data, r.MutableMessage(message, field));
    } else {
      SetValue(data, field, message, 0);
    }
    return;
  }
  const int size = r.FieldSize(*message, field);
  switch (data.ConsumeIntegralInRange(0, 7)) {
    case 0:
      r.ClearField(message, field);
      break;
    case 1:
      for (int n = data.ConsumeIntegralInRange(1, 300); n > 0; --n) {
        if (r.FieldSize(*message, field) == 0) break;
        r.RemoveLast(message, field);
      }
      break;
    case 2:
      for (int n = data.ConsumeIntegralInRange(1, 300); n > 0; --n) {
        Grow(data, field, message);
      }
      break;
    default:
      if (size == 0) {
        Grow(data, field, message);
        break;
      }
      const int index = data.ConsumeIntegralInRange(0, size - 1);
      if (nested) {
        Mutate(data, r.MutableRepeatedMessage(message, field, index));
      } else {
        SetValue(data, field, message, index);
      }
  }
}

void RequireDistribution(std::span<const double> probability) {
  double sum = 0;
  for (const double p : probability) {
    REQUIRE(p >= 0 && p <= 1);
    sum += p;
  }
  REQUIRE(std::abs(sum - 1) < 1e-6);
}

void Classify(
    FuzzedDataProvider& data,
    const std::shared_ptr<const tactus::internal::CompiledModel>& model) {
  tactus::internal::ContactClassifier classifier(model, {});
  const auto taxels =
      static_cast<uint32_t>(tactus::internal::TaxelsNeeded(model->model()));
  for (int i = 0; i < 30; ++i) {
    tactus::internal::ContactSample sample = {
        {1.0 + i, 1e-4 * i, 1e-3 * i}, 2.0 + i, {}};
    sample.profile.fill(0.1 * i);
    if (data.ConsumeBool()) {
      // What the largest taxels and poses can give.
      sample = {{tactus::internal::limits::kMaxTaxelValue, 4096, 1e6},
                4096 * double{tactus::internal::limits::kMaxTaxelValue},
                {}};
      sample.profile.fill(data.ConsumeFloatingPointInRange(0.0, 1e8));
    }
    std::vector<tactus::internal::TaxelLoad> loads;
    for (uint32_t taxel = 0; taxel < std::min(taxels, 40U);
         taxel += data.ConsumeIntegralInRange(1U, 9U)) {
      const bool largest = data.ConsumeBool();
      loads.push_back(
          {taxel,
           std::sqrt(largest ? tactus::internal::limits::kMaxTaxelValue
                             : data.ConsumeFloatingPointInRange(1e-6F, 1e3F))});
    }
    sample.loads = loads;
    classifier.Step(sample, data.ConsumeIntegralInRange(0, 20));
    RequireDistribution(classifier.probability());
    RequireDistribution(classifier.hmm_probability());
    if (!classifier.lstm_probability().empty()) {
      RequireDistribution(classifier.lstm_probability());
    }
    for (const double l : classifier.log_likelihood()) {
      REQUIRE(std::isfinite(l));
    }
    REQUIRE(classifier.unknown() >= 0 && classifier.unknown() <= 1);
    if (const auto& object = classifier.object()) {
      REQUIRE(std::isfinite(object->log10_stiffness));
      REQUIRE(std::isfinite(object->log10_stiffness_deviation));
      REQUIRE(std::isfinite(object->moved_m));
      REQUIRE(std::isfinite(object->moved_deviation_m));
    }
  }
}

tactus::v1::ModelBundle DefaultModel() {
  return tactus::internal::ModelToProto(
      (*tactus::internal::DecodeBundle(
           tactus::internal::server::DefaultBundle()))
          ->model());
}

// A model of three classes, by a preset without HMMs.
tactus::v1::ModelBundle FittedModel(const char* preset) {
  const auto contacts = tactus::internal::testing::ContactsByPattern();
  std::vector<const tactus::internal::LabelledContact*> pointers;
  for (const auto& contact : contacts) pointers.push_back(&contact);
  return tactus::internal::ModelToProto(*tactus::internal::FitModel(
      pointers, *tactus::internal::FitPreset(preset),
      tactus::internal::RunSerially));
}

tactus::v1::ModelBundle SmallModel() {
  tactus::internal::Model model = tactus::internal::testing::SmallModel();
  model.layout = *tactus::internal::LayoutPreset("cody-forearm");
  model.inputs.lstm = model.inputs.hmm;
  tactus::internal::testing::AddLstmCalibration(model.calibration);
  const auto network = [](int regressions) {
    return tactus::internal::RandomNetwork(
        2, {3, 2}, 4, tactus::internal::Activation::kTanh,
        tactus::internal::GateActivation::kSigmoid, 1, 1, regressions);
  };
  model.lstms = {network(0), network(0)};
  model.estimator = network(2);
  model.warm_up.samples.assign(5, {{2.0, 0.0, 0.001}, 2.0, {}});
  model.warm_up.probability.assign(4, 0.25);
  model.warm_up.log_likelihood.assign(4, -1);
  return tactus::internal::ModelToProto(model);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const large = new tactus::v1::ModelBundle(DefaultModel());
  static const auto* const small = new tactus::v1::ModelBundle(SmallModel());
  static const auto* const fitted = new std::array{
      FittedModel("ridge"), FittedModel("trees"), FittedModel("nearest")};
  FuzzedDataProvider data(bytes, size);
  const int which = data.ConsumeIntegralInRange(0, 15);
  tactus::v1::ModelBundle bundle = which == 0  ? *large
                                   : which < 7 ? (*fitted)[which % 3]
                                               : *small;
  for (int n = data.ConsumeIntegralInRange(0, 6); n > 0; --n) {
    Mutate(data, &bundle);
  }
  const auto model = tactus::internal::DecodeBundle(
      tactus::internal::testing::SealedBundle(bundle.SerializeAsString()));
  if (!model.ok()) {
    REQUIRE(!tactus::internal::ReasonOf(model.status()).empty());
    return 0;
  }
  // A warm-up trial that other numbers answer is no reason not to go on.
  tactus::internal::RunWarmUp(**model).IgnoreError();
  Classify(data, *model);
  return 0;
}
