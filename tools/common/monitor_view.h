// File: monitor_view.h
//
// What a terminal shows of a skin and of what a model thinks of it: a heatmap,
// the features, the posterior, the state of the connection, and further lines.
//
//   MonitorState state = monitor.Snapshot(driver.Statistics());
//   state.footer = {"q ends"};
//   for (const std::string& line : RenderMonitor(state, {80, 24, true})) {
//     Print(line);
//   }
//
// Thread-safe: plain data and a free function without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/skin/layout.h"

namespace tactus::internal::client {

struct MonitorState {
  // The first line, e.g. the model's version.
  std::string title;
  SkinLayout layout;
  // rows x columns values in the layout's unit; empty before the first frame.
  std::vector<float> values;
  // Load of the last colour, in the same unit.
  double full_scale = 1;

  // Contacts on the skin, and the largest of them.
  int contacts = 0;
  bool in_contact = false;
  uint64_t contact_id = 0;
  double contact_s = 0;
  double max_force = 0;
  uint32_t area_taxels = 0;
  double area_m2 = 0;
  double motion_m = 0;

  // One per class; empty without a server.
  std::vector<std::string> class_names;
  std::vector<double> probability;
  double unknown = 0;
  // The decision's class and time since onset.
  std::optional<int> decision;
  double decision_ms = 0;

  // The skin's frames. Times in milliseconds; below 0 if unknown.
  double rate_hz = 0;
  double configured_hz = 0;
  uint64_t frames = 0;
  uint64_t lost = 0;
  uint64_t overwritten = 0;
  bool connected = true;
  double age_p50_ms = -1;
  double age_p99_ms = -1;
  // From sending a frame to its answer.
  double answer_p50_ms = -1;
  double answer_p99_ms = -1;
  uint64_t superseded = 0;

  // The last lines.
  std::vector<std::string> footer;
};

struct ScreenStyle {
  int columns = 80;
  int rows = 24;
  // Colours and characters beyond ASCII.
  bool colour = true;
};

// `style.rows` lines of at most `style.columns` characters.
std::vector<std::string> RenderMonitor(const MonitorState& state,
                                       const ScreenStyle& style);

}  // namespace tactus::internal::client
