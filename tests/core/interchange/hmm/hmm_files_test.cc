// HMMs as JSON and .npz: what is written is read, and each mistake is named.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "core/base/errors.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/interchange/hmm/hmm_fields.h"
#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/core/interchange/golden.h"
#include "tests/core/interchange/samples.h"

namespace tactus::internal {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

void ExpectSame(const GaussianHmm& a, const GaussianHmm& b) {
  EXPECT_EQ(a.states, b.states);
  EXPECT_EQ(a.dimensions, b.dimensions);
  EXPECT_EQ(a.covariance_type, b.covariance_type);
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.transition, b.transition);
  EXPECT_EQ(a.means, b.means);
  EXPECT_EQ(a.covariances, b.covariances);
}

// `foreign` holds the HMMs of `model`, with their covariances in full where
// `full`, and what it states about inputs.
void ExpectHolds(const ForeignModel& foreign, const Model& model, bool full) {
  ASSERT_EQ(foreign.hmms.size(), model.hmms.size());
  for (size_t k = 0; k < model.hmms.size(); ++k) {
    EXPECT_EQ(foreign.hmms[k].class_name, model.class_names[k]);
    const HmmMixture& got = foreign.hmms[k].mixture;
    const HmmMixture& want = model.hmms[k];
    ASSERT_EQ(got.components.size(), want.components.size());
    for (size_t i = 0; i < want.components.size(); ++i) {
      EXPECT_NEAR(got.log_weight[i], want.log_weight[i], 1e-15);
      ExpectSame(
          got.components[i],
          full ? WithCovarianceType(want.components[i], CovarianceType::kFull)
               : want.components[i]);
    }
  }
  EXPECT_EQ(foreign.hmm_score, model.hmm_score);
  EXPECT_EQ(foreign.sample_rate_hz, model.inputs.sample_rate_hz);
  ASSERT_TRUE(foreign.steps.has_value());
  EXPECT_EQ(foreign.steps->max, model.inputs.hmm_steps.max);
  ASSERT_EQ(foreign.inputs.size(), model.inputs.hmm.size());
  for (size_t i = 0; i < foreign.inputs.size(); ++i) {
    EXPECT_EQ(foreign.inputs[i].cue, model.inputs.hmm[i].cue);
    EXPECT_EQ(foreign.inputs[i].log_offset, model.inputs.hmm[i].log_offset);
    EXPECT_EQ(foreign.inputs[i].gain, model.inputs.hmm[i].gain);
    EXPECT_EQ(foreign.inputs[i].limit, model.inputs.hmm[i].limit);
  }
}

Model Sample() {
  Model model = HmmSample();
  model.hmm_score = Score::kViterbi;
  model.inputs.hmm_steps = {3, 40};
  model.class_names[2] = "gr\xC3\xBCn \"soft\"";
  return model;
}

TEST(HmmFilesTest, WhatIsWrittenIsReadBitForBit) {
  const Model model = Sample();
  for (const HmmJsonStyle style :
       {HmmJsonStyle::kHmmlearn, HmmJsonStyle::kGhmm}) {
    const auto foreign = HmmsFromJson("x.json", HmmsToJson(model, style));
    ASSERT_TRUE(foreign.ok()) << foreign.status();
    ExpectHolds(*foreign, model, style == HmmJsonStyle::kGhmm);
  }
  const auto bytes = HmmsToNpz(model);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const auto foreign = HmmsFromNpz("x.npz", *bytes);
  ASSERT_TRUE(foreign.ok()) << foreign.status();
  ExpectHolds(*foreign, model, false);
}

// One HMM as json.dumps or numpy.savez makes it of a fitted GaussianHMM.
json SingleHmm() {
  return {{"covariance_type", "diag"},
          {"startprob_", {0.25, 0.75}},
          {"transmat_", {{0.5, 0.5}, {0, 1}}},
          {"means_", {{1, 2}, {3, 4}}},
          // hmmlearn's getter gives N x D x D.
          {"covars_", {{{1, 0}, {0, 2}}, {{3, 0}, {0, 4}}}}};
}

absl::StatusOr<ForeignModel> FromJson(const json& value) {
  return HmmsFromJson("x.json", value.dump());
}

TEST(HmmFilesTest, OneHmmAloneIsRead) {
  const auto foreign = FromJson(SingleHmm());
  ASSERT_TRUE(foreign.ok()) << foreign.status();
  ASSERT_EQ(foreign->hmms.size(), 1u);
  EXPECT_EQ(foreign->hmms[0].class_name, "");
  const GaussianHmm& hmm = foreign->hmms[0].mixture.components[0];
  EXPECT_EQ(hmm.covariance_type, CovarianceType::kDiagonal);
  EXPECT_EQ(hmm.covariances, (std::vector<double>{1, 2, 3, 4}));

  const std::vector<double> start = {1};
  const std::vector<double> mean = {3, 4};
  const std::vector<double> tied = {2, 1, 1, 2};
  const auto numbers = [](std::vector<size_t> shape,
                          const std::vector<double>& values) {
    return NpyBytes(shape, std::span<const double>(values));
  };
  const auto npz =
      HmmsFromNpz("x.npz", *NpzBytes({{"startprob_", numbers({1}, start)},
                                      {"transmat_", numbers({1, 1}, start)},
                                      {"means_", numbers({1, 2}, mean)},
                                      {"covars_", numbers({2, 2}, tied)},
                                      {"covariance_type", NpyText("tied")}}));
  ASSERT_TRUE(npz.ok()) << npz.status();
  EXPECT_EQ(npz->hmms[0].mixture.components[0].covariances, tied);
}

// hmmlearn's default is float64, but users round and use float32.
TEST(HmmFilesTest, RoundedProbabilitiesAreMadeToSumToOne) {
  json hmm = SingleHmm();
  hmm["startprob_"] = {0.333333, 0.666667 + 4e-7};
  const auto foreign = FromJson(hmm);
  ASSERT_TRUE(foreign.ok()) << foreign.status();
  const auto& start = foreign->hmms[0].mixture.components[0].start;
  EXPECT_NEAR(start[0] + start[1], 1, 1e-15);
  hmm["startprob_"] = {0.333, 0.666};
  EXPECT_EQ(ReasonOf(FromJson(hmm).status()), "INVALID_MODEL");
}

struct BadHmm {
  const char* text;
  // Changes the JSON of a good file of one HMM, or of classes.
  void (*change)(json&);
};

class BadHmmTest : public ::testing::TestWithParam<BadHmm> {};

TEST_P(BadHmmTest, IsRefusedByName) {
  json file = SingleHmm();
  GetParam().change(file);
  const auto foreign = FromJson(file);
  EXPECT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL");
  EXPECT_THAT(std::string(foreign.status().message()), HasSubstr("x.json: "));
  EXPECT_THAT(std::string(foreign.status().message()),
              HasSubstr(GetParam().text));
}

json Classes(std::initializer_list<json> hmms) {
  return {{"classes", {{{"name", "HU"}, {"hmms", json::array_t(hmms)}}}}};
}

INSTANTIATE_TEST_SUITE_P(
    All, BadHmmTest,
    ::testing::Values(
        BadHmm{"JSON object", [](json& j) { j = json::array(); }},
        BadHmm{"covariance_type is absent",
               [](json& j) { j.erase("covariance_type"); }},
        BadHmm{"covariance_type is round",
               [](json& j) { j["covariance_type"] = "round"; }},
        BadHmm{"startprob_ is absent", [](json& j) { j.erase("startprob_"); }},
        BadHmm{"shape of startprob_ is (3)",
               [](json& j) {
                 j["startprob_"] = {0.5, 0.25, 0.25};
               }},
        BadHmm{"transmat_[1] is a list of 1; it must be a list of 2",
               [](json& j) {
                 j["transmat_"] = {{0.5, 0.5}, {1}};
               }},
        BadHmm{"means_ is string", [](json& j) { j["means_"] = "1 2 3 4"; }},
        BadHmm{"shape of means_ is (2)",
               [](json& j) {
                 j["means_"] = {1, 2};
               }},
        BadHmm{"shape of covars_",
               [](json& j) {
                 j["covars_"] = {{1, 2, 3}, {4, 5, 6}};
               }},
        BadHmm{"covars_ of state 1 is 0.5",
               [](json& j) { j["covars_"][1][0][1] = 0.5; }},
        BadHmm{"mixtures of Gaussians in a state (GMMHMM)",
               [](json& j) {
                 j["weights_"] = {{1}, {1}};
               }},
        BadHmm{"start",
               [](json& j) {
                 j["startprob_"] = {-0.5, 1.5};
               }},
        BadHmm{"covar", [](json& j) { j["covars_"][0][0][0] = -1; }},
        BadHmm{"B[0][1] is a list of 3; it must be a list of 4",
               [](json& j) {
                 j = {{"A", {{1}}}, {"pi", {1}}, {"B", {{{1, 2}, {1, 0, 1}}}}};
               }},
        BadHmm{"B is of another form",
               [](json& j) {
                 j = {{"A", {{1}}}, {"pi", {1}}, {"B", {1}}};
               }},
        BadHmm{"pi is absent",
               [](json& j) {
                 j = {{"A", {{1}}}, {"B", {{{1}, {1}}}}};
               }},
        BadHmm{"classes is 0 entries",
               [](json& j) {
                 j = {{"classes", json::array()}};
               }},
        BadHmm{"class 0 is object",
               [](json& j) {
                 j = {{"classes", {{{"name", "HU"}}}}};
               }},
        BadHmm{"class 0 (HU) hmm 0 is number",
               [](json& j) { j = Classes({1}); }},
        BadHmm{"class 0 (HU) weights is 1; it must be 2",
               [](json& j) {
                 j = Classes({SingleHmm(), SingleHmm()});
                 j["classes"][0]["weights"] = {1};
               }},
        BadHmm{"class 0 (HU): ",
               [](json& j) {
                 j = Classes({SingleHmm(), SingleHmm()});
                 j["classes"][0]["weights"] = {0.5, 0.25};
               }},
        BadHmm{"version",
               [](json& j) {
                 j = Classes({SingleHmm()});
                 j["version"] = 2;
               }},
        BadHmm{"score",
               [](json& j) {
                 j = Classes({SingleHmm()});
                 j["score"] = "best";
               }},
        BadHmm{"inputs cue is warmth",
               [](json& j) {
                 j = Classes({SingleHmm()});
                 j["inputs"] = {{{"cue", "warmth"}}};
               }},
        BadHmm{"max_interval is 0.5", [](json& j) {
                 j = Classes({SingleHmm()});
                 j["max_interval"] = 0.5;
               }}));

TEST(HmmFilesTest, PicklesInsideAreRefusedByName) {
  std::string pickle = NpyText("x");
  const size_t type = pickle.find("'<U1'");
  pickle.replace(type, 5, "'|O' ");
  const auto foreign =
      HmmsFromNpz("x.npz", *NpzBytes({{"covariance_type", pickle}}));
  EXPECT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL");
  EXPECT_THAT(std::string(foreign.status().message()),
              HasSubstr("array covariance_type.npy: holds '|O', Python objects "
                        "in a pickle"));
}

TEST(HmmFilesTest, DamageIsRefusedOrGivesAValidModel) {
  const auto check = [](const absl::StatusOr<ForeignModel>& foreign) {
    if (!foreign.ok()) {
      ASSERT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL");
      ASSERT_THAT(std::string(foreign.status().message()), HasSubstr("hmms."));
      return;
    }
    for (const NamedMixture& named : foreign->hmms) {
      ASSERT_TRUE(Validate(named.mixture).ok());
    }
  };
  const std::string text = Golden("hmms.json");
  const std::string archive = Golden("hmms.npz");
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    std::string bad = text;
    bad[random.Index(bad.size())] ^= static_cast<char>(1 << random.Index(8));
    check(HmmsFromJson("hmms.json", bad));
    bad = archive;
    bad[random.Index(bad.size())] ^= static_cast<char>(1 << random.Index(8));
    check(HmmsFromNpz("hmms.npz", bad));
  }
  for (size_t length = 0; length + 2 < text.size(); length += 7) {
    const auto foreign = HmmsFromJson("hmms.json", text.substr(0, length));
    ASSERT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL") << length;
  }
  for (size_t length = 0; length < archive.size(); length += 7) {
    const auto foreign = HmmsFromNpz("hmms.npz", archive.substr(0, length));
    ASSERT_EQ(ReasonOf(foreign.status()), "INVALID_MODEL") << length;
  }
}

}  // namespace
}  // namespace tactus::internal
