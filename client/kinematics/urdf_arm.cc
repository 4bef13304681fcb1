// ArmModel::FromUrdf(): urdfdom reads the file, KDL computes the pose.
#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/kinematics/arm_model.h"
#include "client/kinematics/urdf_text.h"
#include "console_bridge/console.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "kdl/chain.hpp"
#include "urdf_model/model.h"
#include "urdf_parser/urdf_parser.h"

namespace tactus::internal::client {
namespace {

using Joints = std::vector<urdf::JointSharedPtr>;

// Links that an error lists.
constexpr size_t kListedLinks = 30;

// Keeps the first error that urdfdom logs, in place of standard error.
class FirstError : public console_bridge::OutputHandler {
 public:
  FirstError() { console_bridge::useOutputHandler(this); }
  ~FirstError() override { console_bridge::restorePreviousOutputHandler(); }

  void log(const std::string& text, console_bridge::LogLevel level,
           const char* /*file*/, int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text_.empty()) {
      text_ = text;
    }
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// Ends a model. Its links own their children, so those of a loop would never
// end, and those of a chain would end within each other.
struct TakeApart {
  void operator()(urdf::ModelInterface* model) const {
    for (auto& [name, link] : model->links_) link->child_links.clear();
  }

  urdf::ModelInterfaceSharedPtr owner;
};

absl::StatusOr<urdf::ModelInterfaceSharedPtr> Parse(absl::string_view text) {
  TACTUS_RETURN_IF_ERROR(CheckUrdfText(text));
  // The handler of messages is one for the process.
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  FirstError error;
  std::string problem;
  try {
    const auto model = urdf::parseURDF(std::string(text));
    if (model != nullptr) {
      return urdf::ModelInterfaceSharedPtr(model.get(), TakeApart{model});
    }
    problem = error.text();
  } catch (const std::exception& e) {
    problem = e.what();
  }
  return InvalidConfig("the file", absl::StrCat("not readable (", problem, ")"),
                       "a URDF");
}

std::string ListLinks(const urdf::ModelInterface& model) {
  std::string list;
  size_t listed = 0;
  for (const auto& [name, link] : model.links_) {
    if (++listed > kListedLinks) {
      return absl::StrCat(list, " and ", model.links_.size() - kListedLinks,
                          " more");
    }
    absl::StrAppend(&list, listed > 1 ? ", " : "", Printable(name));
  }
  return list;
}

absl::Status BadJoint(const urdf::Joint& joint, absl::string_view got,
                      absl::string_view want) {
  return InvalidConfig(absl::StrCat("joint ", Printable(joint.name)), got,
                       want);
}

bool IsUsable(double number) {
  return std::abs(number) <= limits::kMaxJointValue;
}

absl::Status CheckJoint(const urdf::Joint& joint) {
  const urdf::Vector3& at = joint.parent_to_joint_origin_transform.position;
  if (!IsUsable(at.x) || !IsUsable(at.y) || !IsUsable(at.z)) {
    return BadJoint(joint, "an origin far away",
                    absl::StrCat("metres, at most ", limits::kMaxJointValue));
  }
  switch (joint.type) {
    case urdf::Joint::FIXED:
      return absl::OkStatus();
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
    case urdf::Joint::PRISMATIC:
      break;
    default:
      return BadJoint(joint,
                      joint.type == urdf::Joint::PLANAR     ? "planar"
                      : joint.type == urdf::Joint::FLOATING ? "floating"
                                                            : "of no type",
                      "revolute, continuous, prismatic or fixed");
  }
  const double length = std::hypot(joint.axis.x, joint.axis.y, joint.axis.z);
  if (!(length > 1e-6 && IsUsable(length))) {
    return BadJoint(joint, absl::StrCat("an axis of length ", length),
                    "an axis of length 1");
  }
  if (joint.mimic != nullptr &&
      (!IsUsable(joint.mimic->multiplier) || !IsUsable(joint.mimic->offset))) {
    return BadJoint(joint, "a mimic without usable numbers",
                    absl::StrCat("a multiplier and an offset of at most ",
                                 limits::kMaxJointValue));
  }
  return absl::OkStatus();
}

// The joints above `link`, from the base on.
absl::StatusOr<Joints> JointsAbove(const urdf::ModelInterface& model,
                                   urdf::LinkConstSharedPtr link) {
  Joints joints;
  while (link != nullptr && link->parent_joint != nullptr) {
    const urdf::JointSharedPtr joint = link->parent_joint;
    // urdfdom takes both mistakes.
    const auto parents = std::count_if(
        model.joints_.begin(), model.joints_.end(), [&](const auto& entry) {
          return entry.second->child_link_name == link->name;
        });
    if (parents != 1) {
      return InvalidConfig(absl::StrCat("link ", Printable(link->name)),
                           absl::StrCat("the child of ", parents, " joints"),
                           "the child of one joint");
    }
    if (joints.size() == model.joints_.size()) {
      return BadJoint(*joint, "part of a loop", "part of a tree");
    }
    TACTUS_RETURN_IF_ERROR(CheckJoint(*joint));
    joints.push_back(joint);
    link = link->getParent();
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

KDL::Vector ToKdl(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

KDL::Segment MakeSegment(const urdf::Joint& joint) {
  const urdf::Pose& origin = joint.parent_to_joint_origin_transform;
  const urdf::Rotation& q = origin.rotation;
  const KDL::Frame frame(KDL::Rotation::Quaternion(q.x, q.y, q.z, q.w),
                         ToKdl(origin.position));
  if (joint.type == urdf::Joint::FIXED) {
    return KDL::Segment(joint.name, KDL::Joint(joint.name, KDL::Joint::Fixed),
                        frame);
  }
  const auto type = joint.type == urdf::Joint::PRISMATIC ? KDL::Joint::TransAxis
                                                         : KDL::Joint::RotAxis;
  return KDL::Segment(
      joint.name,
      KDL::Joint(joint.name, frame.p, frame.M * ToKdl(joint.axis), type),
      frame);
}

// One segment, and how its joint's value follows from the arm's values.
struct Link {
  KDL::Segment segment;
  // -1: it is fixed.
  int value = -1;
  double multiplier = 1;
  double offset = 0;
};

class KdlChain : public ArmChain {
 public:
  explicit KdlChain(std::vector<Link> links) : links_(std::move(links)) {}

  Pose PoseOf(std::span<const double> values) override {
    KDL::Frame frame = KDL::Frame::Identity();
    for (const Link& link : links_) {
      const double value =
          link.value < 0
              ? 0
              : link.multiplier * values[static_cast<size_t>(link.value)] +
                    link.offset;
      frame = frame * link.segment.pose(value);
    }
    Pose pose;
    pose.position = {frame.p.x(), frame.p.y(), frame.p.z()};
    Eigen::Quaterniond& q = pose.orientation;
    frame.M.GetQuaternion(q.x(), q.y(), q.z(), q.w());
    q.normalize();
    return pose;
  }

 private:
  const std::vector<Link> links_;
};

// The joint of `chain` with this name; -1 if there is none.
int Find(const Joints& chain, const std::string& name) {
  const auto found = std::find_if(
      chain.begin(), chain.end(),
      [&](const urdf::JointSharedPtr& joint) { return joint->name == name; });
  return found == chain.end() ? -1 : static_cast<int>(found - chain.begin());
}

// Follows the mimics from joint `at` of `chain` to the joint that has a value.
// Returns it; `link` gets the product of what lies between.
absl::StatusOr<int> Resolve(const Joints& chain, int at, Link& link) {
  const urdf::Joint& first = *chain[static_cast<size_t>(at)];
  for (size_t steps = 0; steps <= chain.size(); ++steps) {
    const urdf::Joint& joint = *chain[static_cast<size_t>(at)];
    if (joint.mimic == nullptr) {
      if (joint.type == urdf::Joint::FIXED) {
        return BadJoint(first, "a mimic of a fixed joint",
                        "a mimic of a joint that moves");
      }
      return at;
    }
    link.offset += link.multiplier * joint.mimic->offset;
    link.multiplier *= joint.mimic->multiplier;
    at = Find(chain, joint.mimic->joint_name);
    if (at < 0) {
      return BadJoint(
          joint,
          absl::StrCat("a mimic of ", Printable(joint.mimic->joint_name)),
          "a mimic of a joint between the base and the skin");
    }
  }
  return BadJoint(first, "a mimic of itself", "a mimic of another joint");
}

ArmJoint Describe(const urdf::Joint& joint) {
  ArmJoint described = {.name = Printable(joint.name),
                        .slides = joint.type == urdf::Joint::PRISMATIC,
                        .endless = joint.type == urdf::Joint::CONTINUOUS};
  if (joint.limits != nullptr) {
    described.lower = joint.limits->lower;
    described.upper = joint.limits->upper;
  }
  return described;
}

}  // namespace

absl::StatusOr<ArmModel> ArmModel::FromUrdf(absl::string_view urdf,
                                            const std::string& skin_link) {
  TACTUS_ASSIGN_OR_RETURN(const auto model, Parse(urdf));
  const urdf::LinkConstSharedPtr link = model->getLink(skin_link);
  if (link == nullptr) {
    return InvalidConfig("link of the skin", Quoted(skin_link),
                         absl::StrCat("one of ", ListLinks(*model)));
  }
  TACTUS_ASSIGN_OR_RETURN(const Joints chain, JointsAbove(*model, link));
  // Which value each joint has.
  std::vector<int> value_of(chain.size(), -1);
  std::vector<ArmJoint> joints;
  for (size_t i = 0; i < chain.size(); ++i) {
    if (chain[i]->type == urdf::Joint::FIXED || chain[i]->mimic != nullptr) {
      continue;
    }
    value_of[i] = static_cast<int>(joints.size());
    joints.push_back(Describe(*chain[i]));
  }
  if (joints.empty()) {
    return InvalidConfig("link of the skin", Quoted(skin_link),
                         "a link below a joint that moves");
  }
  std::vector<Link> links;
  for (size_t i = 0; i < chain.size(); ++i) {
    Link next = {.segment = MakeSegment(*chain[i])};
    if (chain[i]->type != urdf::Joint::FIXED) {
      TACTUS_ASSIGN_OR_RETURN(const int leader,
                              Resolve(chain, static_cast<int>(i), next));
      next.value = value_of[static_cast<size_t>(leader)];
    }
    links.push_back(std::move(next));
  }
  return ArmModel(std::move(joints),
                  std::make_unique<KdlChain>(std::move(links)));
}

}  // namespace tactus::internal::client
