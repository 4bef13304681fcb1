// The C interface: its answers are those of the C++ interface, bit for bit, and
// what it cannot take it refuses. tests/client/c/calls.c is the C program.
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/c/include/tactus.h"
#include "client/c/structs.h"
#include "gtest/gtest.h"
#include "tactus/classifier.h"
#include "tests/client/c/calls.h"
#include "tests/client/front/front_frames.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::c {
namespace {

using testing::CodyFrame;
using testing::CodySkin;
using testing::Touch;

std::string BuiltInModel() {
  const char* const root = std::getenv("TACTUS_SOURCE_DIR");
  return absl::StrCat(root == nullptr ? "." : root,
                      "/server/registry/no-poses.tactus");
}

// 13 contacts, some of which end while frames go on.
std::vector<testing::Counts> ManyFrames() {
  std::vector<testing::Counts> frames;
  for (uint64_t seed = 1; seed <= 13; ++seed) {
    const auto contact = testing::Contact(60, seed);
    frames.insert(frames.end(), contact.begin(), contact.end());
    frames.resize(frames.size() + 70, testing::Untouched());
  }
  return frames;
}

void AddContact(const Contact& contact, std::string& text) {
  const auto number = [&](double value) {
    absl::StrAppendFormat(&text, " %a", value);
  };
  absl::StrAppend(&text, " contact ", contact.id, " ",
                  static_cast<int>(contact.state), " ", contact.onset_sequence,
                  " ", contact.since_onset_ns);
  number(contact.unknown);
  if (contact.motion_m) text += " moved", number(*contact.motion_m);
  if (contact.patch) {
    const ContactPatch& patch = *contact.patch;
    text += " patch";
    number(patch.force), number(patch.max_force), number(patch.area_m2);
    number(patch.centroid_row), number(patch.centroid_column);
    absl::StrAppend(&text, " ", patch.area_taxels);
    const auto at = [](const Point3& point, int axis) {
      return axis == 0 ? point.x : axis == 1 ? point.y : point.z;
    };
    for (int axis = 0; axis < 3; ++axis) {
      number(at(patch.centroid.link, axis));
      number(at(patch.centroid.link_normal, axis));
      if (patch.centroid.world) number(at(*patch.centroid.world, axis));
      if (patch.centre_of_pressure) {
        number(at(patch.centre_of_pressure->link, axis));
      }
    }
    for (const int taxel : patch.taxels) absl::StrAppend(&text, " ", taxel);
  }
  for (const NamedProbability& named : contact.classes) {
    text += " " + named.name, number(named.probability);
  }
  for (const QuestionAnswer& question : contact.answers) {
    text += " " + question.question;
    for (const NamedProbability& named : question.values) {
      text += " " + named.name, number(named.probability);
    }
    if (!question.decided) continue;
    absl::StrAppend(&text, " decided ", question.decided->value, " ",
                    question.decided->sequence, " ",
                    question.decided->since_onset_ns, " ",
                    question.decided->changes);
  }
  if (contact.object) {
    text += " object";
    number(contact.object->log10_stiffness);
    number(contact.object->log10_stiffness_deviation);
    number(contact.object->moved_m);
    number(contact.object->moved_deviation_m);
  }
}

// As calls.c writes it.
std::string TextOf(const Answer& answer) {
  std::string text = absl::StrCat(
      "answer ", answer.sequence, " ", answer.capture_time_ns, " ",
      answer.frames_missing, " ", answer.regions, " ", answer.is_final ? 1 : 0);
  for (const Contact& contact : answer.contacts) AddContact(contact, text);
  text += "\n";
  for (const Event& event : answer.events) {
    absl::StrAppend(&text, "event ", static_cast<int>(event.kind), " ",
                    event.contact, " ", event.sequence, " ",
                    event.since_onset_ns);
    if (!event.question.empty()) {
      absl::StrAppend(&text, " ", event.question, " ", event.value);
    }
    text += "\n";
  }
  return text;
}

TEST(CInterfaceTest, ItsAnswersAreThoseOfCppBitForBit) {
  const auto classifier = Classifier::Load(BuiltInModel());
  ASSERT_TRUE(classifier.ok()) << classifier.status();
  std::string in_cpp;
  const auto stream = *classifier->Open(
      CodySkin(), {.with_taxels = true, .on_answer = [&](const Answer& answer) {
                     in_cpp += TextOf(answer);
                   }});
  std::vector<float> values;
  const auto frames = ManyFrames();
  for (size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(stream->Push(CodyFrame(i + 1, frames[i])).ok());
    values.insert(values.end(), frames[i].begin(), frames[i].end());
  }
  ASSERT_TRUE(stream->EndTrial().ok());
  ASSERT_TRUE(stream->Close().ok());

  const played_frames played = {.values = values.data(),
                                .frames = frames.size(),
                                .values_each = testing::kCodyTaxels};
  std::string in_c(2 * in_cpp.size() + 1024, '\0');
  const size_t size = play_in_c(BuiltInModel().c_str(), testing::kStep, &played,
                                in_c.data(), in_c.size());
  ASSERT_GT(size, 0u) << in_c.c_str();
  in_c.resize(std::min(size, in_c.size()));
  EXPECT_GT(in_cpp.size(), 100'000u);
  EXPECT_NE(in_cpp.find(" decided "), std::string::npos);
  EXPECT_TRUE(in_c == in_cpp) << "C:\n"
                              << in_c.substr(0, 2000) << "\nC++:\n"
                              << in_cpp.substr(0, 2000);
}

TEST(CInterfaceTest, WhatItCannotTakeItRefuses) {
  const ScratchDir scratch;
  const std::string damaged = scratch / "bad.tactus";
  std::ofstream(damaged) << "no model";
  EXPECT_EQ(refusals_in_c(BuiltInModel().c_str(), damaged.c_str()), 0);
}

TEST(CInterfaceTest, AFrameAllocatesNothing) {
  tactus_model* model = nullptr;
  ASSERT_EQ(tactus_model_load(BuiltInModel().c_str(), &model, nullptr),
            TACTUS_OK);
  tactus_skin skin = TACTUS_SKIN_INIT;
  skin.name = "cody-forearm";
  skin.scale = testing::kStep;
  tactus_stream* stream = nullptr;
  ASSERT_EQ(tactus_stream_open(model, &skin, nullptr, &stream, nullptr),
            TACTUS_OK);
  // The stream goes on without its model.
  tactus_model_free(model);
  const Frame touched = CodyFrame(1, Touch(2));
  tactus_frame frame = TACTUS_FRAME_INIT;
  frame.values = touched.values.data();
  frame.count = touched.values.size();
  const auto push = [&] {
    frame.capture_time_ns += 10'000'000;
    ASSERT_EQ(tactus_stream_push(stream, &frame, nullptr), TACTUS_OK);
    tactus_event event = TACTUS_EVENT_INIT;
    while (tactus_stream_poll(stream, &event)) {
    }
  };
  for (int i = 0; i < 100; ++i) push();
  const testing::AllocationCounter counter;
  for (int i = 0; i < 50; ++i) push();
  EXPECT_EQ(counter.count(), 0);
  tactus_stream_free(stream);
}

TEST(CInterfaceTest, AStructOfAnOlderHeaderIsFilledUpToItsEnd) {
  tactus_contact_info older = TACTUS_CONTACT_INFO_INIT;
  older.struct_size = offsetof(tactus_contact_info, since_onset_ns);
  older.since_onset_ns = -7;
  tactus_contact_info full = TACTUS_CONTACT_INFO_INIT;
  full.id = 3;
  full.since_onset_ns = 5;
  CopyOut(full, &older);
  EXPECT_EQ(older.id, 3u);
  EXPECT_EQ(older.since_onset_ns, -7);
  EXPECT_EQ(older.struct_size, offsetof(tactus_contact_info, since_onset_ns));
}

TEST(CInterfaceTest, LongTextsAreCutBetweenCharacters) {
  char text[6];
  CopyText("abcd\u00e9", text);
  EXPECT_STREQ(text, "abcd");
  CopyText("abc\u00e9", text);
  EXPECT_STREQ(text, "abc\u00e9");
  CopyText("", text);
  EXPECT_STREQ(text, "");
}

}  // namespace
}  // namespace tactus::internal::c
