#include "tests/reference/sim/cvode.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "tests/reference/sim/cvode_handles.h"
#include "tests/reference/sim/phase_equations.h"
#include "tests/reference/sim/read_signals.h"

namespace tactus::internal {
namespace {

constexpr int kMaxOrder = 5;
// Contacts that ring faster than this (rad/s, beyond what a 100 Hz skin behind
// a 200 Hz filter can tell) are integrated with SolverOptions::ringing_order.
constexpr double kRingingRate = 1000;

int Derivative(double time, N_Vector y, N_Vector derivative, void* data) {
  static_cast<const PhaseEquations*>(data)->Derivative(
      time, N_VGetArrayPointer(y), N_VGetArrayPointer(derivative));
  return 0;
}

int Jacobian(double, N_Vector, N_Vector, SUNMatrix matrix, void* data, N_Vector,
             N_Vector, N_Vector) {
  static_cast<const PhaseEquations*>(data)->Jacobian(SM_COLS_D(matrix));
  return 0;
}

int Events(double, N_Vector y, double* values, void* data) {
  static_cast<const PhaseEquations*>(data)->Events(N_VGetArrayPointer(y),
                                                   values);
  return 0;
}

void IgnoreMessage(int, const char*, const char*, char*, void*) {}

// One run: the solver, the phase it is in and the samples taken so far.
class Run {
 public:
  Run(const ContactScene& scene, const SolverOptions& options)
      : scene_(scene),
        options_(options),
        legs_(EquilibriumLegs(scene)),
        leg_(legs_.begin()),
        equations_(scene, ContactPhase::kStuck, *leg_) {}

  absl::StatusOr<Trajectory> Go();

 private:
  absl::Status Open();
  // True if the contact of this phase is too fast for the higher orders.
  bool Rings() const;
  // Makes the solver start afresh from the state in y_ at time_.
  absl::Status Restart();
  // Advances to the next event or to `until`, sampling on the way. Returns
  // whether an event was met.
  absl::StatusOr<bool> Advance(double until);
  // Applies the event that CVODE reports to the phase.
  absl::Status Switch();
  void EnterPhase(ContactPhase phase);
  // Appends the samples due up to `time`, from the last step's polynomial.
  absl::Status Sample(double time);
  // Adds the impulse since the last call in this phase, up to `time`.
  void AddImpulse(double time, const double* y);
  absl::Status Failure(absl::string_view what, int flag) const;
  absl::Status TooMany(absl::string_view what, int64_t limit) const;

  double* state() { return N_VGetArrayPointer(y_.get()); }

  const ContactScene& scene_;
  const SolverOptions& options_;
  const std::vector<EquilibriumLeg> legs_;
  std::vector<EquilibriumLeg>::const_iterator leg_;
  PhaseEquations equations_;
  double time_ = 0;
  double phase_start_ = 0;
  double contact_time_ = 0;  // in finished phases
  double impulse_ = 0;       // up to impulse_time_, where impulse_state_ was
  double impulse_time_ = 0;
  SceneState impulse_state_ = {};
  // Where the object rests, if it does: the solver holds it to rounding only.
  double rest_position_ = 0;
  Trajectory trajectory_;
  int64_t steps_ = 0;
  size_t samples_due_ = 0;

  CvodeContext context_;
  CvodeVector y_;
  CvodeVector dense_;
  CvodeVector tolerance_;
  CvodeMatrix matrix_;
  CvodeLinearSolver linear_;
  CvodeMemory cvode_;
};

absl::Status Run::Failure(absl::string_view what, int flag) const {
  return NumericalFailure(absl::StrCat("CVODE ", what, " returned ", flag,
                                       " at ", time_,
                                       " s of the simulated contact"));
}

absl::Status Run::TooMany(absl::string_view what, int64_t limit) const {
  return NumericalFailure(absl::StrCat("more than ", limit, " ", what,
                                       " before ", time_,
                                       " s of the simulated contact"));
}

absl::Status Run::Open() {
  SUNContext context = nullptr;
  if (int flag = SUNContext_Create(nullptr, &context); flag != 0) {
    return Failure("context", flag);
  }
  context_.reset(context);
  y_.reset(N_VNew_Serial(kSceneStates, context));
  dense_.reset(N_VNew_Serial(kSceneStates, context));
  tolerance_.reset(N_VNew_Serial(kSceneStates, context));
  matrix_.reset(SUNDenseMatrix(kSceneStates, kSceneStates, context));
  if (!y_ || !dense_ || !tolerance_ || !matrix_) return Failure("vectors", 0);
  linear_.reset(SUNLinSol_Dense(y_.get(), matrix_.get(), context));
  cvode_.reset(CVodeCreate(CV_BDF, context));
  if (!linear_ || !cvode_) return Failure("create", 0);

  N_VConst(0, y_.get());
  double* tolerance = N_VGetArrayPointer(tolerance_.get());
  tolerance[kDeformation] = options_.force_tolerance / scene_.object_stiffness;
  tolerance[kArmVelocity] = options_.velocity_tolerance;
  tolerance[kObjectPosition] = options_.position_tolerance;
  tolerance[kObjectVelocity] = options_.velocity_tolerance;

  void* cvode = cvode_.get();
  const int flags[] = {
      CVodeInit(cvode, Derivative, 0, y_.get()),
      CVodeSVtolerances(cvode, options_.relative_tolerance, tolerance_.get()),
      CVodeSetLinearSolver(cvode, linear_.get(), matrix_.get()),
      CVodeSetJacFn(cvode, Jacobian),
      CVodeSetUserData(cvode, &equations_),
      CVodeSetMaxOrd(cvode, kMaxOrder),
      CVodeRootInit(cvode, 2, Events),
      CVodeSetNoInactiveRootWarn(cvode),
      CVodeSetErrHandlerFn(cvode, IgnoreMessage, nullptr),
  };
  for (int flag : flags) {
    if (flag != CV_SUCCESS) return Failure("set-up", flag);
  }
  return absl::OkStatus();
}

bool Run::Rings() const {
  const double compliance =
      equations_.arm_compliance + equations_.object_compliance;
  return equations_.stiffness * compliance > kRingingRate * kRingingRate;
}

absl::Status Run::Restart() {
  if (int flag = CVodeReInit(cvode_.get(), time_, y_.get());
      flag != CV_SUCCESS) {
    return Failure("restart", flag);
  }
  // Slip: the force rises through its limit. Stop: the speed falls to zero.
  const bool touching = Touching(equations_.phase);
  int directions[] = {touching ? -1 : 1, Sliding(equations_.phase) ? -1 : 1};
  CVodeSetRootDirection(cvode_.get(), directions);
  CVodeSetMaxOrd(cvode_.get(), Rings() ? options_.ringing_order : kMaxOrder);
  return absl::OkStatus();
}

void Run::AddImpulse(double time, const double* y) {
  impulse_ +=
      equations_.Impulse(time - impulse_time_, impulse_state_.data(), y);
  impulse_time_ = time;
  std::copy_n(y, kSceneStates, impulse_state_.begin());
}

void Run::EnterPhase(ContactPhase phase) {
  AddImpulse(time_, state());
  if (Touching(equations_.phase)) contact_time_ += time_ - phase_start_;
  if (!Sliding(phase)) {
    if (Sliding(equations_.phase)) rest_position_ = state()[kObjectPosition];
    state()[kObjectPosition] = rest_position_;
    state()[kObjectVelocity] = 0;
  }
  phase_start_ = time_;
  std::copy_n(state(), kSceneStates, impulse_state_.begin());
  equations_ = PhaseEquations(scene_, phase, *leg_);
}

absl::Status Run::Sample(double time) {
  const bool touching = Touching(equations_.phase);
  const bool resting = !Sliding(equations_.phase);
  const double* y = N_VGetArrayPointer(dense_.get());
  while (trajectory_.samples.size() < samples_due_) {
    const double t = static_cast<double>(trajectory_.samples.size()) /
                     options_.sample_rate_hz;
    if (t > time) break;
    if (int flag = CVodeGetDky(cvode_.get(), t, 0, dense_.get()); flag != 0) {
      return Failure("interpolation", flag);
    }
    TrajectorySample sample;
    sample.x_arm = y[kObjectPosition] + y[kDeformation];
    sample.v_arm = y[kArmVelocity];
    sample.x_uobj = resting ? rest_position_ : y[kObjectPosition];
    sample.v_uobj = resting ? 0 : y[kObjectVelocity];
    sample.force = std::max(0.0, equations_.stiffness * y[kDeformation]);
    AddImpulse(t, y);
    sample.impulse = impulse_;
    sample.contact_time = contact_time_ + (touching ? t - phase_start_ : 0);
    trajectory_.samples.push_back(sample);
  }
  return absl::OkStatus();
}

absl::StatusOr<bool> Run::Advance(double until) {
  CVodeSetStopTime(cvode_.get(), until);
  while (true) {
    const int flag = CVode(cvode_.get(), until, y_.get(), &time_, CV_ONE_STEP);
    if (flag < 0) return Failure("step", flag);
    TACTUS_RETURN_IF_ERROR(Sample(time_));
    AddImpulse(time_, state());
    if (++steps_ > options_.max_steps) {
      return TooMany("solver steps", options_.max_steps);
    }
    if (flag == CV_ROOT_RETURN) return true;
    if (flag == CV_TSTOP_RETURN) return false;
  }
}

absl::Status Run::Switch() {
  int found[2] = {0, 0};
  CVodeGetRootInfo(cvode_.get(), found);
  EventCounts& events = trajectory_.events;
  const ContactPhase phase = equations_.phase;
  bool touching = Touching(phase);
  bool sliding = Sliding(phase);
  if (found[0] != 0) {
    // Exactly at the surface, so that the next phase starts clean.
    state()[kDeformation] = 0;
    ++(touching ? events.contacts_lost : events.contacts_made);
    touching = !touching;
  }
  if (found[1] != 0 && (sliding || touching)) {
    state()[kObjectVelocity] = 0;
    ++(sliding ? events.stops : events.slips);
    sliding = !sliding;
  }
  if (events.Total() > options_.max_events) {
    return TooMany("contact events", options_.max_events);
  }
  EnterPhase(touching
                 ? (sliding ? ContactPhase::kSliding : ContactPhase::kStuck)
                 : (sliding ? ContactPhase::kCoasting : ContactPhase::kApart));
  return absl::OkStatus();
}

absl::StatusOr<Trajectory> Run::Go() {
  TACTUS_RETURN_IF_ERROR(Open());
  trajectory_.sample_rate_hz = options_.sample_rate_hz;
  samples_due_ = 1 + static_cast<size_t>(std::floor(
                         scene_.duration_s * options_.sample_rate_hz + 1e-9));
  trajectory_.samples.reserve(samples_due_);
  trajectory_.samples.emplace_back();
  trajectory_.samples.back().v_arm = scene_.touch_speed_m_s;
  state()[kArmVelocity] = scene_.touch_speed_m_s;
  while (time_ < scene_.duration_s) {
    const double until = std::min(leg_->end_s, scene_.duration_s);
    TACTUS_RETURN_IF_ERROR(Restart());
    TACTUS_ASSIGN_OR_RETURN(const bool event, Advance(until));
    if (event) {
      TACTUS_RETURN_IF_ERROR(Switch());
    } else if (std::next(leg_) != legs_.end()) {
      ++leg_;
      EnterPhase(equations_.phase);
    }
  }
  // The last sample may lie a rounding beyond the last step.
  while (trajectory_.samples.size() < samples_due_) {
    trajectory_.samples.push_back(trajectory_.samples.back());
  }
  trajectory_.moved = trajectory_.samples.back().x_uobj > 0;
  for (int i = 0; i < kSceneStates; ++i) {
    if (!std::isfinite(state()[i])) {
      return NumericalFailure("the simulated contact is not finite");
    }
  }
  return std::move(trajectory_);
}

}  // namespace

absl::Status Validate(const SolverOptions& options) {
  const struct {
    absl::string_view field;
    double value;
    double low;
    double high;
  } ranges[] = {
      {"solver.relative_tolerance", options.relative_tolerance, 1e-12, 0.1},
      {"solver.force_tolerance", options.force_tolerance, 1e-12, 1},
      {"solver.velocity_tolerance", options.velocity_tolerance, 1e-15, 1},
      {"solver.position_tolerance", options.position_tolerance, 1e-15, 1},
      {"solver.ringing_order", static_cast<double>(options.ringing_order), 1,
       kMaxOrder},
      {"solver.sample_rate_hz", options.sample_rate_hz, 500,
       limits::kMaxTrajectoryRateHz},
  };
  for (const auto& range : ranges) {
    if (!(range.value >= range.low && range.value <= range.high)) {
      return InvalidScene(range.field, range.value,
                          absl::StrCat(range.low, " to ", range.high));
    }
  }
  if (std::fmod(options.sample_rate_hz, 100) != 0) {
    return InvalidScene("solver.sample_rate_hz", options.sample_rate_hz,
                        "a multiple of 100");
  }
  return absl::OkStatus();
}

absl::StatusOr<Trajectory> IntegrateCvode(const ContactScene& scene,
                                          const SolverOptions& options) {
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  TACTUS_RETURN_IF_ERROR(Validate(options));
  return Run(scene, options).Go();
}

absl::StatusOr<SimulatedContact> SimulateByCvode(const TrialSpec& spec,
                                                 const SolverOptions& options,
                                                 bool area) {
  TACTUS_ASSIGN_OR_RETURN(const Trajectory trajectory,
                          IntegrateCvode(SceneOf(spec), options));
  SimulatedContact contact;
  contact.spec = spec;
  contact.signals = ReadSignals(spec.object, trajectory, area);
  contact.moved = trajectory.moved;
  contact.events = trajectory.events;
  return contact;
}

}  // namespace tactus::internal
