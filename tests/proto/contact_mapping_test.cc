// The fields of a Contact against those that others have (docs/contacts.md):
// iCub's skinContactList entry and tactile_msgs/TactileContact. There and back,
// nothing that both have is lost, and what was not measured stays absent.
#include <optional>
#include <string>
#include <vector>

#include "google/protobuf/util/message_differencer.h"
#include "gtest/gtest.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::v1 {
namespace {

// The parts of an entry in the order in which iCub's skinManager writes them.
struct SkinContactEntry {
  uint64_t contact_id = 0;
  // Body part, link and skin part are those of the stream's layout.
  std::optional<Vector3> cop;
  std::optional<Vector3> force;
  std::optional<Vector3> moment;
  std::optional<Vector3> geo_center;
  std::optional<Vector3> normal_dir;
  std::vector<uint32_t> taxels;
  std::optional<double> pressure;
};

// The message of tactile_msgs. Its header's frame_id is the link of the
// stream's layout.
struct TactileContact {
  std::string name;
  std::optional<Vector3> position;
  std::optional<Vector3> normal;
  std::optional<Vector3> force;
  std::optional<Vector3> torque;
};

Vector3 Times(double factor, const Vector3& v) {
  Vector3 scaled;
  scaled.set_x(factor * v.x());
  scaled.set_y(factor * v.y());
  scaled.set_z(factor * v.z());
  return scaled;
}

double Dot(const Vector3& a, const Vector3& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

// The force on the skin points into it.
Vector3 ForceOf(const ContactPatch& patch) {
  return Times(-patch.force(), patch.centroid().link_normal());
}

SkinContactEntry ToEntry(const Contact& contact) {
  SkinContactEntry entry;
  entry.contact_id = contact.id();
  if (!contact.has_patch()) return entry;
  const ContactPatch& patch = contact.patch();
  if (patch.has_centre_of_pressure()) {
    entry.cop = patch.centre_of_pressure().link();
  }
  entry.force = ForceOf(patch);
  entry.geo_center = patch.centroid().link();
  entry.normal_dir = patch.centroid().link_normal();
  entry.taxels.assign(patch.taxels().begin(), patch.taxels().end());
  entry.pressure = patch.force() / patch.area_taxels();
  return entry;
}

Contact FromEntry(const SkinContactEntry& entry) {
  Contact contact;
  contact.set_id(entry.contact_id);
  if (!entry.geo_center) return contact;
  ContactPatch& patch = *contact.mutable_patch();
  patch.set_force(-Dot(*entry.force, *entry.normal_dir));
  patch.set_area_taxels(
      static_cast<uint32_t>(patch.force() / *entry.pressure + 0.5));
  *patch.mutable_centroid()->mutable_link() = *entry.geo_center;
  *patch.mutable_centroid()->mutable_link_normal() = *entry.normal_dir;
  if (entry.cop)
    *patch.mutable_centre_of_pressure()->mutable_link() = *entry.cop;
  patch.mutable_taxels()->Add(entry.taxels.begin(), entry.taxels.end());
  return contact;
}

TactileContact ToTactile(const Contact& contact) {
  TactileContact tactile;
  tactile.name = std::to_string(contact.id());
  if (!contact.has_patch()) return tactile;
  const ContactPatch& patch = contact.patch();
  if (patch.has_centre_of_pressure()) {
    tactile.position = patch.centre_of_pressure().link();
  }
  tactile.normal = patch.centroid().link_normal();
  tactile.force = ForceOf(patch);
  return tactile;
}

Contact FromTactile(const TactileContact& tactile) {
  Contact contact;
  contact.set_id(std::stoull(tactile.name));
  if (!tactile.normal) return contact;
  ContactPatch& patch = *contact.mutable_patch();
  patch.set_force(-Dot(*tactile.force, *tactile.normal));
  *patch.mutable_centroid()->mutable_link_normal() = *tactile.normal;
  if (tactile.position) {
    *patch.mutable_centre_of_pressure()->mutable_link() = *tactile.position;
  }
  return contact;
}

Vector3 Place(double x, double y, double z) {
  Vector3 v;
  v.set_x(x);
  v.set_y(y);
  v.set_z(z);
  return v;
}

// Numbers that are exact in a double, so that nothing rounds.
Contact Touching() {
  Contact contact;
  contact.set_id(7);
  ContactPatch& patch = *contact.mutable_patch();
  patch.set_force(2.5);
  patch.set_area_taxels(5);
  *patch.mutable_centroid()->mutable_link() = Place(0.125, -0.5, 0.25);
  *patch.mutable_centroid()->mutable_link_normal() = Place(0, -1, 0);
  *patch.mutable_centre_of_pressure()->mutable_link() = Place(0.25, -0.5, 0.5);
  for (const uint32_t taxel : {3, 4, 5, 27, 28}) patch.add_taxels(taxel);
  return contact;
}

bool Equal(const Contact& a, const Contact& b) {
  return google::protobuf::util::MessageDifferencer::Equals(a, b);
}

TEST(ContactMappingTest, SkinContactEntryThereAndBack) {
  const Contact contact = Touching();
  const SkinContactEntry entry = ToEntry(contact);
  EXPECT_EQ(entry.force->y(), 2.5);
  EXPECT_EQ(entry.pressure, 0.5);
  EXPECT_TRUE(Equal(FromEntry(entry), contact));
}

TEST(ContactMappingTest, TactileContactThereAndBack) {
  // It has neither the taxels nor the centroid.
  Contact contact = Touching();
  contact.mutable_patch()->clear_taxels();
  contact.mutable_patch()->clear_area_taxels();
  contact.mutable_patch()->mutable_centroid()->clear_link();
  EXPECT_TRUE(Equal(FromTactile(ToTactile(contact)), contact));
}

TEST(ContactMappingTest, WhatIsNotMeasuredStaysAbsent) {
  Contact lost;
  lost.set_id(3);
  Contact without_load = Touching();
  without_load.mutable_patch()->clear_centre_of_pressure();
  for (const Contact& contact : {lost, without_load}) {
    const SkinContactEntry entry = ToEntry(contact);
    EXPECT_FALSE(entry.cop);
    EXPECT_FALSE(entry.moment);
    EXPECT_TRUE(Equal(FromEntry(entry), contact));
    const TactileContact tactile = ToTactile(contact);
    EXPECT_FALSE(tactile.position);
    EXPECT_FALSE(tactile.torque);
    EXPECT_FALSE(FromTactile(tactile).patch().has_centre_of_pressure());
  }
}

}  // namespace
}  // namespace tactus::v1
