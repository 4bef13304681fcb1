#include "tests/reference/sim/coupled_cvode.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/sim/model/equilibrium.h"
#include "tests/reference/sim/cvode_handles.h"

namespace tactus::internal {
namespace {

constexpr double kRelative = 1e-11;
constexpr double kAbsolute = 1e-15;
constexpr int64_t kMostSteps = 50'000'000;

struct Flags {
  bool touching = true;
  bool sliding = false;
};

// State: position and speed of the arm, then of each object.
struct Model {
  const CoupledScene* scene;
  EquilibriumLeg leg;
  std::vector<Flags> flags;

  int count() const { return static_cast<int>(flags.size()); }
  double Deformation(int i, const double* y) const {
    return y[0] - y[2 + 2 * i] - scene->objects[i].distance_m;
  }
  double Force(int i, const double* y) const {
    return flags[i].touching ? scene->objects[i].stiffness * Deformation(i, y)
                             : 0;
  }
};

int CoupledDerivative(double time, N_Vector state, N_Vector derivative,
                      void* data) {
  const Model& model = *static_cast<const Model*>(data);
  const ContactScene& arm = model.scene->arm;
  const double* y = N_VGetArrayPointer(state);
  double* rate = N_VGetArrayPointer(derivative);
  double force = arm.actuator_stiffness * (model.leg.PositionAt(time) - y[0]) +
                 arm.actuator_damping * (model.leg.speed_m_s - y[1]);
  for (int i = 0; i < model.count(); ++i) {
    const CoupledObject& object = model.scene->objects[i];
    const double contact = model.Force(i, y);
    force -= contact;
    const bool sliding = model.flags[i].sliding;
    rate[2 + 2 * i] = sliding ? y[3 + 2 * i] : 0;
    rate[3 + 2 * i] =
        sliding ? contact / object.mass_kg - object.mu_kinetic * kGravity : 0;
  }
  rate[0] = y[1];
  rate[1] = force / arm.arm_mass_kg;
  return 0;
}

// Two for each object: contact, and slip or stop.
int CoupledRoots(double, N_Vector state, double* values, void* data) {
  const Model& model = *static_cast<const Model*>(data);
  const double* y = N_VGetArrayPointer(state);
  for (int i = 0; i < model.count(); ++i) {
    const CoupledObject& object = model.scene->objects[i];
    values[2 * i] = model.Deformation(i, y);
    values[2 * i + 1] = 1;
    if (model.flags[i].sliding) {
      values[2 * i + 1] = y[3 + 2 * i];
    } else if (model.flags[i].touching && !object.fixed) {
      values[2 * i + 1] = model.Force(i, y) - object.StaticLimit();
    }
  }
  return 0;
}

void IgnoreCvode(int, const char*, const char*, char*, void*) {}

class CoupledSolver {
 public:
  CoupledSolver(const CoupledScene& scene, double rate)
      : scene_(scene), rate_(rate), size_(2 + 2 * scene.objects.size()) {
    model_.scene = &scene;
    for (const CoupledObject& object : scene.objects) {
      model_.flags.push_back({.touching = object.distance_m == 0});
    }
  }

  absl::StatusOr<std::vector<Trajectory>> Go();

 private:
  absl::Status Open();
  absl::Status Restart();
  absl::Status Advance(double until);
  void Switch();
  absl::Status Sample();
  void Append(const double* y);

  double* state() { return N_VGetArrayPointer(y_.get()); }

  const CoupledScene& scene_;
  const double rate_;
  const size_t size_;
  Model model_;
  double time_ = 0;
  int64_t steps_ = 0;
  std::vector<Trajectory> out_;
  CvodeContext context_;
  CvodeVector y_;
  CvodeVector dense_;
  CvodeMatrix matrix_;
  CvodeLinearSolver linear_;
  CvodeMemory cvode_;
};

absl::Status CoupledSolver::Open() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) {
    return NumericalFailure("CVODE has no context");
  }
  context_.reset(context);
  const auto size = static_cast<sunindextype>(size_);
  y_.reset(N_VNew_Serial(size, context));
  dense_.reset(N_VNew_Serial(size, context));
  matrix_.reset(SUNDenseMatrix(size, size, context));
  linear_.reset(SUNLinSol_Dense(y_.get(), matrix_.get(), context));
  cvode_.reset(CVodeCreate(CV_BDF, context));
  N_VConst(0, y_.get());
  state()[1] = scene_.arm.touch_speed_m_s;
  void* cvode = cvode_.get();
  const int flags[] = {
      CVodeInit(cvode, CoupledDerivative, 0, y_.get()),
      CVodeSStolerances(cvode, kRelative, kAbsolute),
      CVodeSetLinearSolver(cvode, linear_.get(), matrix_.get()),
      CVodeSetUserData(cvode, &model_),
      CVodeRootInit(cvode, 2 * model_.count(), CoupledRoots),
      CVodeSetNoInactiveRootWarn(cvode),
      CVodeSetErrHandlerFn(cvode, IgnoreCvode, nullptr),
  };
  for (const int flag : flags) {
    if (flag != CV_SUCCESS) return NumericalFailure("CVODE set-up failed");
  }
  return absl::OkStatus();
}

absl::Status CoupledSolver::Restart() {
  if (CVodeReInit(cvode_.get(), time_, y_.get()) != CV_SUCCESS) {
    return NumericalFailure("CVODE restart failed");
  }
  std::vector<int> directions;
  for (const Flags& flags : model_.flags) {
    directions.push_back(flags.touching ? -1 : 1);
    directions.push_back(flags.sliding ? -1 : 1);
  }
  CVodeSetRootDirection(cvode_.get(), directions.data());
  return absl::OkStatus();
}

void CoupledSolver::Append(const double* y) {
  for (int i = 0; i < model_.count(); ++i) {
    out_[i].samples.push_back({.x_arm = y[0],
                               .v_arm = y[1],
                               .x_uobj = y[2 + 2 * i],
                               .v_uobj = y[3 + 2 * i],
                               .force = std::max(0.0, model_.Force(i, y))});
  }
}

// Those due up to time_, from the last step's polynomial.
absl::Status CoupledSolver::Sample() {
  const auto due =
      static_cast<size_t>(std::floor(scene_.arm.duration_s * rate_ + 1e-9));
  while (out_.front().samples.size() <= due) {
    const double t = static_cast<double>(out_.front().samples.size()) / rate_;
    if (t > time_) break;
    if (CVodeGetDky(cvode_.get(), t, 0, dense_.get()) != 0) {
      return NumericalFailure("CVODE interpolation failed");
    }
    Append(N_VGetArrayPointer(dense_.get()));
  }
  return absl::OkStatus();
}

void CoupledSolver::Switch() {
  std::vector<int> found(2 * model_.flags.size());
  CVodeGetRootInfo(cvode_.get(), found.data());
  for (int i = 0; i < model_.count(); ++i) {
    Flags& flags = model_.flags[i];
    EventCounts& events = out_[i].events;
    double* speed = state() + 3 + 2 * i;
    if (found[2 * i] != 0) {
      ++(flags.touching ? events.contacts_lost : events.contacts_made);
      flags.touching = !flags.touching;
    }
    if (found[2 * i + 1] != 0) {
      *speed = 0;
      ++(flags.sliding ? events.stops : events.slips);
      flags.sliding = !flags.sliding;
    }
  }
}

absl::Status CoupledSolver::Advance(double until) {
  TACTUS_RETURN_IF_ERROR(Restart());
  CVodeSetStopTime(cvode_.get(), until);
  while (time_ < until) {
    const int flag = CVode(cvode_.get(), until, y_.get(), &time_, CV_ONE_STEP);
    if (flag < 0 || ++steps_ > kMostSteps) {
      return NumericalFailure(absl::StrCat("CVODE step returned ", flag));
    }
    TACTUS_RETURN_IF_ERROR(Sample());
    if (flag == CV_TSTOP_RETURN) break;
    if (flag != CV_ROOT_RETURN) continue;
    Switch();
    TACTUS_RETURN_IF_ERROR(Restart());
    CVodeSetStopTime(cvode_.get(), until);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Trajectory>> CoupledSolver::Go() {
  out_.resize(model_.flags.size());
  TACTUS_RETURN_IF_ERROR(Open());
  Append(state());
  for (const EquilibriumLeg& leg : EquilibriumLegs(scene_.arm)) {
    const double until = std::min(leg.end_s, scene_.arm.duration_s);
    if (time_ >= until) continue;
    model_.leg = leg;
    TACTUS_RETURN_IF_ERROR(Advance(until));
  }
  const auto due =
      static_cast<size_t>(std::floor(scene_.arm.duration_s * rate_ + 1e-9));
  if (out_.front().samples.size() <= due) Append(state());
  for (int i = 0; i < model_.count(); ++i) {
    out_[i].sample_rate_hz = rate_;
    out_[i].moved = state()[2 + 2 * i] > 0;
  }
  return std::move(out_);
}

}  // namespace

absl::StatusOr<std::vector<Trajectory>> IntegrateCoupledCvode(
    const CoupledScene& scene, double sample_rate_hz) {
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  return CoupledSolver(scene, sample_rate_hz).Go();
}

}  // namespace tactus::internal
