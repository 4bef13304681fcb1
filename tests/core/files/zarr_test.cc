#include "core/files/zarr.h"

#include <filesystem>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/files/file_bytes.h"
#include "core/files/npy_write.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

// A group "g" with one array "a", as text and plain chunks.
void WriteByHand(const ScratchDir& dir, const std::string& description) {
  fs::create_directories(dir / "g/a");
  WriteBytes(dir / "g/.zgroup", R"({"zarr_format": 2})");
  WriteBytes(dir / "g/a/.zarray", description);
}

std::string Described(const std::string& rest) {
  return R"({"zarr_format": 2, "order": "C", "filters": null, )" + rest + "}";
}

std::string Bytes16(const std::vector<uint16_t>& values) {
  return {reinterpret_cast<const char*>(values.data()), 2 * values.size()};
}

TEST(ZarrTest, WhatIsWrittenIsRead) {
  const ScratchDir dir;
  Random random(3);
  // Several chunks, the last one not full.
  std::vector<float> floats(3 * 50 * 7001);
  for (float& value : floats) value = static_cast<float>(random.Gaussian());
  const std::vector<int16_t> words = {-5, 32767};
  const double tenth = 0.1;
  const std::string text = "gr\xC3\xBCn \"x\"\n";
  ASSERT_TRUE(
      WriteZarr(dir / "g",
                {{"f", NpyBytes({7001, 50, 3}, std::span<const float>(floats))},
                 {"w", NpyBytes({1, 2, 1}, std::span<const int16_t>(words))},
                 {"deep/er/number", NpyBytes({}, std::span(&tenth, 1))},
                 {"deep/text", NpyText(text)},
                 {"empty", NpyText("")}})
          .ok());
  EXPECT_TRUE(fs::exists(dir / "g/f/4.0.0"));
  EXPECT_TRUE(IsZarrGroup(dir / "g/deep/er"));
  const auto arrays = ReadZarr(dir / "g");
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_EQ(arrays->size(), 5u);
  EXPECT_THAT(arrays->at("f").shape, ElementsAre(7001, 50, 3));
  EXPECT_EQ(arrays->at("f").f32, floats);
  EXPECT_EQ(arrays->at("w").i16, words);
  EXPECT_THAT(arrays->at("deep/er/number").f64, ElementsAre(0.1));
  EXPECT_THAT(arrays->at("deep/text").text, ElementsAre(text));
  EXPECT_THAT(arrays->at("empty").text, ElementsAre(""));
  // The package zarr 2.13 takes ASCII alone.
  EXPECT_THAT(*ReadFileBytes(dir / "g/deep/.zattrs", 1 << 20),
              HasSubstr("gr\\u00fcn"));
  EXPECT_EQ(ReasonOf(WriteZarr(dir / "g", {})), "IO");
}

// 3 x 5 in chunks of 2 x 2, which are places of a table that is counted
// through; the chunk at the lower right is absent.
TEST(ZarrTest, ChunksOfAnyShapeAreReadAndAbsentOnesAreZero) {
  for (const std::string separator : {".", "/"}) {
    const ScratchDir dir;
    WriteByHand(dir, Described(R"("shape": [3, 5], "chunks": [2, 2],
        "dtype": "<u2", "compressor": null, "fill_value": 0,
        "dimension_separator": ")" +
                               separator + "\""));
    for (int row = 0; row < 2; ++row) {
      if (separator == "/")
        fs::create_directories(dir / ("g/a/" + std::to_string(row)));
      for (int column = 0; column < 3; ++column) {
        if (row == 1 && column == 2) continue;
        std::vector<uint16_t> values;
        for (int r = 2 * row; r < 2 * row + 2; ++r) {
          for (int c = 2 * column; c < 2 * column + 2; ++c) {
            values.push_back(static_cast<uint16_t>(10 * r + c));
          }
        }
        WriteBytes(dir / ("g/a/" + std::to_string(row) + separator +
                          std::to_string(column)),
                   Bytes16(values));
      }
    }
    const auto arrays = ReadZarr(dir / "g");
    ASSERT_TRUE(arrays.ok()) << arrays.status();
    EXPECT_THAT(arrays->at("a").u16, ElementsAre(0, 1, 2, 3, 4, 10, 11, 12, 13,
                                                 14, 20, 21, 22, 23, 0));
  }
}

TEST(ZarrTest, EachMistakeIsNamed) {
  struct Case {
    std::string description;
    const char* text;
  };
  const std::string shape = R"("shape": [2], "chunks": [2], )";
  const std::string type = R"("dtype": "<u2", )";
  const Case cases[] = {
      {"[]", "is no JSON object"},
      {Described(R"("shape": [-1], "chunks": [2])"),
       "shape and chunks must be"},
      {Described(R"("shape": [2], "chunks": [0])"), "shape and chunks must be"},
      {Described(R"("shape": [99999999999], "chunks": [2])"),
       "shape and chunks must be"},
      {Described(shape + R"("dtype": "|O")"), "dtype is"},
      {Described(shape + R"("dtype": [["x", "<f4"]])"), "dtype is"},
      {Described(shape + type + R"("compressor": {"id": "blosc"})"),
       "compressor is \"\\\"blosc\\\"\"; save it with"},
      {Described(shape + type + R"("compressor": 3)"), "compressor is"},
      {R"({"order": "F", "shape": [2], "chunks": [2], "dtype": "<u2"})",
       "order must be C"},
      {Described(shape + type + R"("dimension_separator": "-")"),
       "dimension_separator must be"},
      {Described(shape + type + R"("compressor": {"id": "zlib"})"),
       "is no chunk of 4 bytes"},
      {Described(R"("shape": [3], "chunks": [3], "dtype": "<u2")"),
       "is no chunk of 6 bytes"},
      {Described(R"("shape": [1073741824], "chunks": [1], "dtype": "|u1")"),
       "in 1073741824 chunks of 1"},
  };
  for (const Case& c : cases) {
    const ScratchDir dir;
    WriteByHand(dir, c.description);
    WriteBytes(dir / "g/a/0", Bytes16({7, 8}));
    const absl::Status status = ReadZarr(dir / "g").status();
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << c.text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(c.text));
    EXPECT_THAT(std::string(status.message()), HasSubstr("g/a"));
  }
  const ScratchDir dir;
  EXPECT_THAT(std::string(ReadZarr(dir.path()).status().message()),
              HasSubstr("has no .zgroup"));
  WriteBytes(dir / "zarr.json", "{}");
  EXPECT_THAT(std::string(ReadZarr(dir.path()).status().message()),
              HasSubstr("version 3"));
  WriteByHand(dir, Described(shape + type + R"("fill_value": 1)"));
  EXPECT_FALSE(ReadZarr(dir / "g").ok()) << "a chunk is absent";
  WriteBytes(dir / "g/.zattrs", R"({"b": [1]})");
  EXPECT_THAT(std::string(ReadZarr(dir / "g").status().message()),
              HasSubstr("attribute \"b\" must be a number or text"));
}

// Bytes of the description and of a packed chunk change, or are lost.
TEST(ZarrTest, NoDamageCrashes) {
  const ScratchDir dir;
  const std::vector<uint16_t> words = {1, 2, 3, 4, 5, 6};
  ASSERT_TRUE(
      WriteZarr(dir / "g",
                {{"a", NpyBytes({3, 2}, std::span<const uint16_t>(words))},
                 {"b", NpyText("x")}})
          .ok());
  Random random(5);
  for (const std::string file : {"g/a/.zarray", "g/a/0.0", "g/.zattrs"}) {
    const std::string good = *ReadFileBytes(dir / file, 1 << 20);
    for (int i = 0; i < 2'000; ++i) {
      std::string bad = good;
      for (int hits = 0; hits < 3; ++hits) {
        bad[random.Index(bad.size())] = static_cast<char>(random.Index(256));
      }
      if (random.Index(4) == 0) bad.resize(random.Index(bad.size()));
      WriteBytes(dir / file, bad);
      const absl::Status status = ReadZarr(dir / "g").status();
      if (!status.ok()) {
        EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << status;
      }
    }
    WriteBytes(dir / file, good);
  }
  EXPECT_TRUE(ReadZarr(dir / "g").ok());
}

}  // namespace
}  // namespace tactus::internal
