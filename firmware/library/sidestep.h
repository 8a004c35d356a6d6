#pragma once

#include <array>
#include <memory>
#include <string>

namespace sidestep {

/// The controller as a library: function calls in place of the messages of sidestep-controller.
///
///     sidestep::Controller controller("/usr/share/sidestep/config/lwa3.yaml");
///     every controller.period_s():
///       controller.set_target(target, now_s);               // when there is a new target
///       controller.set_obstacles(obstacles, count, now_s);  // when there is a new set, even an empty one; always all
///       const auto result = controller.step(arm_state, now_s);
///       if (result.commanding) drive(result.position_rad, result.velocity_radps);
///
/// SI units, radians, frame of the base link. now_s is any clock that never goes back, the same in all calls. Inputs
/// time out as configured in the section `timeouts:`. All calls come from one thread. Only the constructors allocate,
/// read files and throw. The caller keeps the period and provides real-time scheduling.
class __attribute__((visibility("default"))) Controller {
 public:
  static constexpr int kMostJoints = 10;
  static constexpr int kMostObstacles = 4096;
  static constexpr int kMostHeldShapes = 16;
  static constexpr int kMostAllowed = 64;

  using Vector = std::array<double, 3>;            ///< x y z
  using Quaternion = std::array<double, 4>;        ///< w x y z, of length 1
  using Joints = std::array<double, kMostJoints>;  ///< the first joints() count, from the base on; rad and
                                                   ///< rad/s, or m and m/s for a prismatic joint

  /// Foresight plans detours out of dead ends: on its own thread, or within step(), which then takes longer but is
  /// deterministic. The configuration can switch it off as well.
  enum class Foresight { kOnThread, kWithinStep, kOff };

  /// A configuration file of sidestep-controller. Throws std::runtime_error, one line that names the file and the key;
  /// also for a file with neighbours.listen: pass the neighbours' links as obstacles instead.
  explicit Controller(const std::string& config_file, Foresight foresight = Foresight::kOnThread);
  /// The chain between two links of a URDF, with default settings.
  Controller(const std::string& urdf, const std::string& base, const std::string& tip,
             Foresight foresight = Foresight::kOnThread);
  ~Controller();

  int joints() const;
  double period_s() const;

  struct Target {
    Vector position_m{};
    Vector velocity_mps{};
    bool tracks_orientation = false;  ///< a full pose; otherwise the next two are ignored
    Quaternion orientation{1, 0, 0, 0};
    Vector angular_velocity_radps{};
  };
  /// Returns false and keeps the previous target when a number is implausible.
  bool set_target(const Target& target, double now_s);
  /// A posture of all joints, clamped to the position limits, in place of a target of the tool: the newest of both
  /// counts. Returns false and keeps the previous target when a number is implausible.
  bool set_joint_target(const Joints& position_rad, double now_s);

  enum class Shape { kSphere, kCapsule, kBox, kCylinder };
  struct Obstacle {
    int id = 0;  ///< constant over the life of the obstacle
    Shape shape = Shape::kSphere;
    Vector position_m{};                 ///< centre
    Quaternion orientation{1, 0, 0, 0};  ///< ignored for a sphere
    Vector size_m{};        ///< sphere {radius}; along z: capsule {radius, distance of cap centres}, cylinder {radius,
                            ///< height}; box {edge, edge, edge}
    Vector velocity_mps{};  ///< 0: at rest or unknown; an obstacle that moves gets an estimate
    Vector angular_velocity_radps{};  ///< likewise
    bool is_person = false;           ///< keeps the full clearance also at rest
  };
  /// An obstacle that is missing in the new set is remembered for timeouts.coast_s and extrapolated with its velocity.
  /// Returns false and keeps the previous set when a number is implausible or there are too many obstacles.
  bool set_obstacles(const Obstacle* obstacles, int count, double now_s);

  /// What the tool holds: `count` shapes in the tool's frame, whose velocities do not count; and what the tool and what
  /// it holds may touch: `allowed_count` ids of obstacles. It counts until the next call; none of either lets go. An
  /// allowed obstacle with the id of a held shape is that shape: no link avoids it. Returns false and keeps the
  /// previous ones when a number is implausible or there are too many.
  bool set_attachments(const Obstacle* shapes, int count, const int* allowed, int allowed_count, double now_s);

  struct Control {
    bool paused = false;       ///< the arm slows to rest and keeps avoiding obstacles
    double speed_scale = 1.0;  ///< 0 to 1: of the speed with which the arm follows its target
  };
  /// Before the first call, and without timeouts.control_s: not paused, full speed. Returns false and keeps the
  /// previous one when the scale is not from 0 to 1.
  bool set_control(const Control& control, double now_s);

  struct ArmState {
    Joints position_rad{};
    Joints velocity_radps{};
  };
  // As in controller_status_t:
  enum class Mode { kWait, kHold, kTrack, kBrake, kFault };
  enum Fault { kFaultNone = 0, kFaultArmStateLost = 1, kFaultArmStateInconsistent = 2, kFaultNotFinite = 3 };
  enum Limiting {  ///< bits
    kLimitingVelocity = 1,
    kLimitingAcceleration = 2,
    kLimitingPosition = 4,
    kLimitingTaskSpeed = 8,
    kLimitingShield = 16,
    kLimitingShieldFailed = 2048,
    kLimitingSelf = 4096,
  };
  struct Result {
    bool commanding = false;  ///< send the next two to the arm; false while waiting and after a fault
    Joints position_rad{};    ///< at the end of the coming period
    Joints velocity_radps{};  ///< for the coming period
    Mode mode = Mode::kWait;
    int fault = kFaultNone;
    int limiting = 0;              ///< bit set of Limiting: what limits the command in this cycle
    double speed_scale = 1;        ///< of set_control(); 0 while paused
    const char* message = "";      ///< the reason for the mode, static text
    double target_distance_m = 0;  ///< of the tool, to its place in a posture target; NaN without a target
    double clearance_m = 0;        ///< surface to surface; NaN before the first obstacle set
    int nearest_obstacle = -1;     ///< its id
    bool guided = false;           ///< this cycle followed a guide of foresight
    Vector tool_position_m{};
    Vector tool_velocity_mps{};
  };
  /// One cycle with the arm state measured at now_s.
  Result step(const ArmState& arm, double now_s);
  /// One cycle without a new arm state; after timeouts.arm_state_s without one the arm brakes.
  Result step(double now_s);

  /// All following cycles brake the arm to rest and keep it there. For a stop that can be resumed: set_control().
  void stop();

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace sidestep
