// File: raw_type.h
//
// A type of Cyclone DDS whose samples are the bytes of a message, as they
// travel. So a program reads and writes topics of any type of ROS 2, and needs
// no code that is generated for each.
//
//   ddsi_sertype* type = MakeRawType("std_msgs::msg::dds_::String_");
//   const dds_entity_t topic = dds_create_topic_sertype(
//       participant, "rt/chatter", &type, nullptr, nullptr, nullptr);
//   if (topic < 0) ddsi_sertype_unref(type);
//
// A sample to write is a string_view, a sample to read a std::string. Both
// begin with the four bytes that name the encoding. Messages larger than
// limits::kMaxBagMessageBytes are dropped. Cyclone DDS keeps the type from then
// on. Thread-safe: a free function without state.
#pragma once

#include <string>

#include "dds/dds.h"
#include "dds/ddsi/ddsi_sertype.h"

namespace tactus::internal::client {

// `name` as DDS has it.
ddsi_sertype* MakeRawType(const std::string& name);

}  // namespace tactus::internal::client
