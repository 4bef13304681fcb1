#include "tests/fuzz/any_skin.h"

#include <algorithm>
#include <cstring>

namespace tactus::internal::fuzz {
namespace {

constexpr double kScale = 0.001;

void AddMask(FuzzedDataProvider& data, v1::SensorGeometry* geometry) {
  const uint32_t taxels = geometry->rows() * geometry->columns();
  const int masked = data.ConsumeIntegralInRange(0, 6);
  for (int i = 0; i < masked; ++i) {
    geometry->add_masked_taxels(
        data.ConsumeIntegralInRange<uint32_t>(0, taxels - 1));
  }
}

void AddLightTouch(FuzzedDataProvider& data, v1::SensorGeometry* geometry) {
  v1::LightTouch* light = geometry->mutable_light_touch();
  light->set_window_s(data.PickValueInArray({0.01, 0.05, 1.0}));
  light->set_rows(
      data.ConsumeIntegralInRange<uint32_t>(1, std::min(geometry->rows(), 3U)));
  light->set_columns(data.ConsumeIntegralInRange<uint32_t>(
      1, std::min(geometry->columns(), 3U)));
  light->set_contact_threshold(0.01);
  light->set_onset_threshold(data.ConsumeBool() ? 0.01 : 0.02);
}

void SetGeometry(FuzzedDataProvider& data, v1::SensorGeometry* geometry) {
  geometry->set_layout("fuzz");
  geometry->set_rows(data.ConsumeIntegralInRange(1, 10));
  geometry->set_columns(data.ConsumeIntegralInRange(1, 24));
  geometry->set_row_pitch_m(0.01);
  geometry->set_column_pitch_m(0.01);
  geometry->set_taxel_area_m2(1e-4);
  geometry->set_wrap_columns(data.ConsumeBool());
  geometry->set_unit(data.ConsumeBool() ? v1::TAXEL_UNIT_NEWTON
                                        : v1::TAXEL_UNIT_COUNTS);
  geometry->set_contact_threshold(0.1);
  geometry->set_onset_threshold(data.ConsumeBool() ? 0.1 : 0.2);
  geometry->set_connectivity(
      static_cast<v1::Connectivity>(data.ConsumeIntegralInRange(0, 2)));
  if (data.ConsumeBool()) AddMask(data, geometry);
  if (data.ConsumeBool()) AddLightTouch(data, geometry);
  geometry->set_axes(data.ConsumeBool() ? 3 : 1);
  if (data.ConsumeBool()) {
    geometry->set_normal_axis(data.ConsumeIntegralInRange(0, 2));
  }
  geometry->set_signed_values(data.ConsumeBool());
}

}  // namespace

v1::StreamConfig AnyConfig(FuzzedDataProvider& data) {
  v1::StreamConfig config;
  SetGeometry(data, config.mutable_geometry());
  config.set_taxel_type(data.PickValueInArray(
      {v1::TAXEL_TYPE_UINT16, v1::TAXEL_TYPE_INT16, v1::TAXEL_TYPE_FLOAT32}));
  if (config.taxel_type() != v1::TAXEL_TYPE_FLOAT32) config.set_scale(kScale);
  config.set_with_poses(data.ConsumeBool());
  config.set_with_taxels(data.ConsumeBool());
  config.set_with_diagnostics(data.ConsumeBool());
  config.set_never_release(data.ConsumeBool());
  if (!config.never_release()) {
    config.set_release_after_ms(data.ConsumeIntegralInRange(1, 300));
  }
  if (data.ConsumeBool()) {
    config.set_max_contacts(data.ConsumeIntegralInRange(1, 8));
  }
  config.set_cadence(
      static_cast<v1::ResultCadence>(data.ConsumeIntegralInRange(0, 4)));
  config.set_result_interval_frames(data.ConsumeIntegralInRange(1, 4));
  config.set_effort(static_cast<v1::Effort>(data.ConsumeIntegralInRange(0, 2)));
  return config;
}

Presses::Presses(const v1::StreamConfig& config)
    : rows_(config.geometry().rows()),
      columns_(config.geometry().columns()),
      axes_(std::max(config.geometry().axes(), 1U)),
      normal_(config.geometry().has_normal_axis()
                  ? config.geometry().normal_axis()
                  : axes_ - 1),
      signed_(config.geometry().signed_values()),
      type_(config.taxel_type()) {}

void Presses::Change(FuzzedDataProvider& data) {
  Object& object =
      objects_[data.ConsumeIntegralInRange<size_t>(0, objects_.size() - 1)];
  switch (data.ConsumeIntegralInRange(0, 3)) {
    case 0:
      object.load = 0;
      break;
    case 1:
      object.row = data.ConsumeIntegralInRange<uint32_t>(0, rows_ - 1);
      object.column = data.ConsumeIntegralInRange<uint32_t>(0, columns_ - 1);
      object.rows = data.ConsumeIntegralInRange(1, 3);
      object.columns = data.ConsumeIntegralInRange(1, 3);
      object.load = data.PickValueInArray({50, 150, 2'000, 30'000});
      break;
    case 2:
      object.column = (object.column + 1) % columns_;
      break;
    default:
      object.load = std::min(2 * object.load, 30'000);
      object.shear = data.ConsumeIntegralInRange(-300, 300);
  }
}

int Presses::ValueAt(size_t place) const {
  const uint32_t axis = place % axes_;
  const uint32_t taxel = place / axes_;
  int value = 0;
  for (const Object& object : objects_) {
    if (object.load == 0) continue;
    // Across the last column they go on at the first.
    const uint32_t right =
        (taxel % columns_ + columns_ - object.column) % columns_;
    const uint32_t down = taxel / columns_ - object.row;
    if (down >= object.rows || right >= object.columns) continue;
    value += axis == normal_ ? object.load : object.shear;
  }
  return std::clamp(value, signed_ ? -30'000 : 0, 30'000);
}

void Presses::Append(int value, std::string* bytes) const {
  const auto append = [&](auto number) {
    char buffer[sizeof(number)];
    std::memcpy(buffer, &number, sizeof(number));
    bytes->append(buffer, sizeof(number));
  };
  if (type_ == v1::TAXEL_TYPE_FLOAT32) {
    append(static_cast<float>(value * kScale));
  } else {
    append(static_cast<int16_t>(value));
  }
}

void Presses::AppendTo(bool sparse, v1::FrameBatch* batch) const {
  uint32_t listed = 0;
  for (size_t place = 0; place < values(); ++place) {
    const int value = ValueAt(place);
    if (!sparse) {
      Append(value, batch->mutable_taxels());
      continue;
    }
    if (value == 0) continue;
    ++listed;
    const char index[] = {static_cast<char>(place % 256),
                          static_cast<char>(place / 256)};
    batch->mutable_sparse()->mutable_indices()->append(index, 2);
    Append(value, batch->mutable_sparse()->mutable_values());
  }
  if (sparse) batch->mutable_sparse()->add_counts(listed);
}

}  // namespace tactus::internal::fuzz
