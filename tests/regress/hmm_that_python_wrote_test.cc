// An HMM whose training had failed was called "not JSON", because Python writes
// NaN; and a last state that hmmlearn never saw left, with a row of zeros, was
// refused.
#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

absl::StatusOr<ForeignModel> Read(const std::string& transmat,
                                  const std::string& means) {
  return HmmsFromJson("x.json",
                      absl::StrCat("{\"covariance_type\": \"spherical\", "
                                   "\"startprob_\": [1, 0, 0], \"transmat_\": ",
                                   transmat, ", \"means_\": ", means,
                                   ", \"covars_\": [1, 1, 1]}"));
}

constexpr char kGood[] = "[[0.5, 0.5, 0], [0, 0.5, 0.5], [0, 0, 1]]";
constexpr char kMeans[] = "[[1, 2], [3, 4], [5, 6]]";

std::string MessageOf(const absl::StatusOr<ForeignModel>& model) {
  EXPECT_EQ(ReasonOf(model.status()), "INVALID_MODEL");
  return std::string(model.status().message());
}

TEST(HmmThatPythonWroteTest, NumbersThatAreNotFiniteAreNamed) {
  ASSERT_TRUE(Read(kGood, kMeans).ok()) << Read(kGood, kMeans).status();
  EXPECT_THAT(MessageOf(Read(kGood, "[[1, 2], [3, NaN], [5, 6]]")),
              HasSubstr("means_[1][1] is NaN"));
  EXPECT_THAT(MessageOf(Read(kGood, "[[-Infinity, 2], [3, 4], [5, 6]]")),
              HasSubstr("means_[0][0] is -Infinity"));
  EXPECT_THAT(
      MessageOf(Read("[[0.5, Infinity, 0], [0, 1, 0], [0, 0, 1]]", kMeans)),
      HasSubstr("transmat_[0][1] is Infinity"));
  EXPECT_THAT(MessageOf(Read(kGood, "[[1, 2], [3, 4], [null, 6]]")),
              HasSubstr("means_[2][0] is null"));
  EXPECT_THAT(MessageOf(HmmsFromJson("x.json",
                                     "{\"A\": [[1]], \"pi\": [1], "
                                     "\"B\": [[[0, NaN], [1, 0, 0, 1]]]}")),
              HasSubstr("B[0][0][1] is NaN"));
}

TEST(HmmThatPythonWroteTest, HmmsOfSymbolsAreNamed) {
  for (const char* array : {"emissionprob_", "lambdas_"}) {
    const std::string text = absl::StrCat(
        "{\"startprob_\": [1], \"transmat_\": [[1]], \"", array, "\": [[1]]}");
    EXPECT_THAT(MessageOf(HmmsFromJson("x.json", text)),
                HasSubstr(absl::StrCat(array, " is there")));
  }
}

TEST(HmmThatPythonWroteTest, TextsAndNamesAreNamed) {
  EXPECT_THAT(MessageOf(Read(kGood, "[[1, 2], [3, 4], [\"5\", 6]]")),
              HasSubstr("means_[2][0] is the text \"5\""));
  EXPECT_THAT(MessageOf(HmmsFromJson(
                  "x.json", "{\"HU\": {\"means_\": [[1]]}, \"SU\": {}}")),
              HasSubstr("HMMs by names, \"HU\"; it must be one HMM, or"));
}

TEST(HmmThatPythonWroteTest, NaNWithinTextsIsText) {
  const auto named = HmmsFromJson(
      "x.json",
      "{\"note\": \"\\\"NaN: Infinity\", \"A\": [[1]], \"pi\": [1], "
      "\"B\": [[[0], [1]]]}");
  EXPECT_TRUE(named.ok()) << named.status();
}

TEST(HmmThatPythonWroteTest, NumbersInNpzAreNamedToo) {
  const std::vector<double> one = {1};
  const std::vector<double> mean = {0, std::nan("")};
  const auto numbers = [](std::vector<size_t> shape,
                          const std::vector<double>& values) {
    return NpyBytes(shape, std::span<const double>(values));
  };
  const auto model = HmmsFromNpz(
      "x.npz", *NpzBytes({{"startprob_", numbers({1}, one)},
                          {"transmat_", numbers({1, 1}, one)},
                          {"means_", numbers({1, 2}, mean)},
                          {"covars_", numbers({1}, one)},
                          {"covariance_type", NpyText("spherical")}}));
  EXPECT_THAT(MessageOf(model), HasSubstr("means_[0][1] is NaN"));
}

TEST(HmmThatPythonWroteTest, ALastStateThatIsNeverLeftStays) {
  const auto model = Read("[[0.5, 0.5, 0], [0, 0.5, 0.5], [0, 0, 0]]", kMeans);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_THAT(model->hmms[0].mixture.components[0].transition,
              ElementsAre(0.5, 0.5, 0, 0, 0.5, 0.5, 0, 0, 1));
}

TEST(HmmThatPythonWroteTest, AnyOtherRowOfZerosIsNamed) {
  EXPECT_THAT(MessageOf(Read("[[0.5, 0.5, 0], [0, 0, 0], [0, 0, 1]]", kMeans)),
              HasSubstr("transmat_[1] is a row of zeros"));
}

}  // namespace
}  // namespace tactus::internal
