// A stream of three signed axes gives the answers of the pipeline, in each
// encoding, and those of a skin that sends the loads alone.
#include <cmath>
#include <cstring>

#include "core/base/random.h"
#include "core/skin/layout_proto.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"

namespace tactus::internal::server {
namespace {

constexpr double kAxesScale = testing::kStep;

SkinLayout AxesSkin() {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.name = "mine";
  layout.axes = 3;
  layout.normal_axis = 1;
  layout.signed_values = true;
  layout.mask.assign(layout.taxels(), 1);
  layout.mask[300] = 0;
  return layout;
}

// Counts of all axes: the loads of a contact on axis 1, shear beside them.
std::vector<std::vector<int16_t>> FramesOfAxes(uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<int16_t>> frames;
  for (const testing::Counts& counts : testing::Contact(60, seed)) {
    std::vector<int16_t> frame;
    for (const uint16_t count : counts) {
      for (const double value :
           {900 * random.Gaussian(), count > 0 ? 1.0 * count : -3.0,
            -200 * random.Gaussian()}) {
        frame.push_back(static_cast<int16_t>(std::lround(value)));
      }
    }
    // Nobody reads what a masked taxel holds.
    frame[3 * 300 + 1] = 32'000;
    frames.push_back(frame);
  }
  return frames;
}

std::vector<double> OfflineOfAxes(
    const testing::TestModels& models, const SkinLayout& layout,
    const std::vector<std::vector<float>>& frames) {
  ContactPipeline::Options options;
  options.with_poses = false;
  auto pipeline = *ContactPipeline::Create(layout, models.model(), options);
  std::vector<double> answers;
  for (const std::vector<float>& frame : frames) {
    pipeline->Step({.taxels = frame});
    const ContactReport* contact = pipeline->main_contact();
    if (contact == nullptr || contact->released()) continue;
    answers.push_back(contact->features->net_force);
    const auto probability = contact->classifier->probability();
    answers.insert(answers.end(), probability.begin(), probability.end());
  }
  return answers;
}

template <typename Number>
void AppendNumber(Number number, std::string* bytes) {
  char buffer[sizeof(number)];
  std::memcpy(buffer, &number, sizeof(number));
  bytes->append(buffer, sizeof(number));
}

// The values of a frame, as the stream's type; those that are not 0 if
// `sparse`.
void AddAxesFrame(const std::vector<int16_t>& frame, v1::TaxelType type,
                  bool sparse, v1::FrameBatch* batch) {
  std::string* values = sparse ? batch->mutable_sparse()->mutable_values()
                               : batch->mutable_taxels();
  uint32_t count = 0;
  for (size_t i = 0; i < frame.size(); ++i) {
    if (sparse && frame[i] == 0) continue;
    ++count;
    if (sparse) {
      AppendNumber(static_cast<uint16_t>(i),
                   batch->mutable_sparse()->mutable_indices());
    }
    if (type == v1::TAXEL_TYPE_INT16) {
      AppendNumber(frame[i], values);
    } else {
      AppendNumber(static_cast<float>(frame[i] * kAxesScale), values);
    }
  }
  if (sparse) batch->mutable_sparse()->add_counts(count);
}

std::vector<double> OnlineOfAxes(
    const testing::TestModels& models,
    const std::vector<std::vector<int16_t>>& frames, v1::TaxelType type,
    bool sparse) {
  StreamSession session(&models, {});
  v1::ClassifyContactRequest request = testing::ConfigRequest();
  v1::StreamConfig* config = request.mutable_config();
  config->clear_never_release();
  *config->mutable_geometry() = LayoutToProto(AxesSkin());
  config->set_taxel_type(type);
  config->set_scale(type == v1::TAXEL_TYPE_INT16 ? kAxesScale : 1);
  EXPECT_TRUE(session.OnRequest(request).ok()) << session.final_status();
  std::vector<double> answers;
  uint64_t sequence = 0;
  for (const std::vector<int16_t>& frame : frames) {
    request.Clear();
    v1::FrameBatch* batch = request.mutable_frames();
    batch->set_first_sequence(++sequence);
    batch->set_first_capture_time_ns(static_cast<int64_t>(sequence) *
                                     10'000'000);
    batch->set_frame_count(1);
    AddAxesFrame(frame, type, sparse, batch);
    EXPECT_TRUE(session.OnRequest(request).ok()) << session.final_status();
    while (const auto* response = session.responses().StartWrite(0)) {
      if (response->has_answer() && !response->answer().contacts().empty()) {
        const v1::Contact& contact = response->answer().contacts(0);
        if (contact.state() != v1::Contact::STATE_RELEASED) {
          answers.push_back(contact.patch().force());
          answers.insert(answers.end(), contact.probability().begin(),
                         contact.probability().end());
        }
      }
      session.responses().FinishWrite();
    }
  }
  return answers;
}

TEST(AxesTest, AStreamGivesThePipelinesBits) {
  const testing::TestModels models;
  SkinLayout line = AxesSkin();
  line.axes = 1;
  line.normal_axis.reset();
  line.signed_values = false;
  for (const uint64_t seed : {1, 2, 3}) {
    const auto counts = FramesOfAxes(seed);
    std::vector<std::vector<float>> frames;
    std::vector<std::vector<float>> loads;
    for (const std::vector<int16_t>& frame : counts) {
      std::vector<float>& values = frames.emplace_back();
      for (const int16_t count : frame) {
        values.push_back(static_cast<float>(count * kAxesScale));
      }
      std::vector<float>& load = loads.emplace_back();
      for (size_t i = 1; i < values.size(); i += 3) {
        load.push_back(std::max(values[i], 0.0F));
      }
    }
    const std::vector<double> want = OfflineOfAxes(models, AxesSkin(), frames);
    ASSERT_GT(want.size(), 50U);
    EXPECT_EQ(OfflineOfAxes(models, line, loads), want);
    for (const bool sparse : {false, true}) {
      for (const v1::TaxelType type :
           {v1::TAXEL_TYPE_INT16, v1::TAXEL_TYPE_FLOAT32}) {
        EXPECT_EQ(OnlineOfAxes(models, counts, type, sparse), want)
            << "seed " << seed << " type " << type << " sparse " << sparse;
      }
    }
  }
}

}  // namespace
}  // namespace tactus::internal::server
