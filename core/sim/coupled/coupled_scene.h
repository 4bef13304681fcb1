// File: coupled_scene.h
//
// CoupledScene: one arm that presses against up to four objects, each at its
// own distance ahead of it. Arm, objects and friction are those of a
// ContactScene (scene.h); what the objects press on the arm adds up, so each of
// them holds the arm back from the others.
//
//   CoupledScene both = {.arm = scene, .objects = {ObjectOf(scene)}};
//   both.objects.push_back(ObjectOf(other));
//   both.objects.back().distance_m = 0.002;
//   TACTUS_RETURN_IF_ERROR(Validate(both));
//
// Plain data, SI units; safe to share between threads once built.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/sim/model/scene.h"

namespace tactus::internal {

// As in ContactScene.
struct CoupledObject {
  double mass_kg = 0;
  double stiffness = 0;
  double mu_static = 0;
  double mu_kinetic = 0;
  bool fixed = false;
  // From the arm to the undeformed object at time 0, m: 0 to 10.
  double distance_m = 0;

  double StaticLimit() const { return mu_static * mass_kg * kGravity; }
  double KineticFriction() const { return mu_kinetic * mass_kg * kGravity; }
};

struct CoupledScene {
  // The arm, the way of its equilibrium point, and the duration. The object of
  // this scene is not read.
  ContactScene arm;
  // 1 to limits::kMaxSceneObjects.
  std::vector<CoupledObject> objects;
};

// The object of `scene`, at distance 0.
CoupledObject ObjectOf(const ContactScene& scene);

// OK if every field is in range; else INVALID_SCENE naming the field.
absl::Status Validate(const CoupledScene& scene);

}  // namespace tactus::internal
