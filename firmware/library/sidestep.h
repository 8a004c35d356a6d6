#pragma once

#include <array>
#include <memory>
#include <string>

namespace sidestep {

/// The controller in a process of your own: what sidestep-controller does with messages, as calls.
///
///     sidestep::Controller controller("/usr/share/sidestep/config/lwa3.yaml");
///     every controller.period_s():
///       controller.set_target(target, now_s);               // when there is a new one
///       controller.set_obstacles(obstacles, count, now_s);  // likewise; always the full set, an empty one too
///       const auto result = controller.step(arm_state, now_s);
///       if (result.commanding) drive(result.position_rad, result.velocity_radps);
///
/// SI units, radians, the frame of the base link. now_s is any clock that never goes back, the same in all calls;
/// inputs count as long as the section `ages:` of the configuration says. One thread makes all calls. Only the
/// constructor allocates, reads files and throws. Keeping to the period, and real-time scheduling, are the caller's.
class __attribute__((visibility("default"))) Controller {
 public:
  static constexpr int kMostJoints = 10;
  static constexpr int kMostObstacles = 4096;

  using Vector = std::array<double, 3>;            ///< x y z
  using Quaternion = std::array<double, 4>;        ///< w x y z, of length 1
  using Joints = std::array<double, kMostJoints>;  ///< the first joints() count, from the base on

  /// Foresight looks for ways out of dead ends: on a thread of its own, or within step(), which then takes longer but
  /// does the same in every run. The configuration may switch it off as well.
  enum class Foresight { kOnThread, kWithinStep, kOff };

  /// What sidestep-controller takes as --config. Throws std::runtime_error, one line, naming the file and the key; also
  /// for one that listens to neighbours, whose links belong among the obstacles here.
  explicit Controller(const std::string& config_file, Foresight foresight = Foresight::kOnThread);
  /// The arm between two links of a URDF, all else default.
  Controller(const std::string& urdf, const std::string& base, const std::string& tip,
             Foresight foresight = Foresight::kOnThread);
  ~Controller();

  int joints() const;
  double period_s() const;

  struct Target {
    Vector position_m{};
    Vector velocity_mps{};
    bool tracks_orientation = false;  ///< the rest counts
    Quaternion orientation{1, 0, 0, 0};
    Vector angular_velocity_radps{};
  };
  /// Returns false, and the target before it stays, when a number cannot be true.
  bool set_target(const Target& target, double now_s);

  enum class Shape { kSphere, kCapsule, kBox };
  struct Obstacle {
    int id = 0;  ///< the same as long as it is the same obstacle
    Shape shape = Shape::kSphere;
    Vector position_m{};                 ///< centre
    Quaternion orientation{1, 0, 0, 0};  ///< not of a sphere
    Vector size_m{};  ///< radius; radius and distance between the cap centres, along z; or the edges of a box
    Vector velocity_mps{};
    Vector angular_velocity_radps{};
  };
  /// An obstacle that is left out counts for 0.3 s more, moved on with its velocity.
  /// Returns false, and the set before it stays, when a number cannot be true or there are too many.
  bool set_obstacles(const Obstacle* obstacles, int count, double now_s);

  struct ArmState {
    Joints position_rad{};
    Joints velocity_radps{};
  };
  enum class Mode { kWait, kHold, kTrack, kBrake, kFault };  ///< as in controller_status_t, with fault and limiting
  struct Result {
    bool commanding = false;  ///< the next two are to be sent; false while waiting and after a fault
    Joints position_rad{};    ///< where the velocity leads in one period
    Joints velocity_radps{};  ///< for the coming period
    Mode mode = Mode::kWait;
    int fault = 0;
    int limiting = 0;
    const char* message = "";      ///< what it waits for or why it holds
    double target_distance_m = 0;  ///< NaN without a target
    double clearance_m = 0;        ///< from surface to surface; NaN before the first set of obstacles
    int nearest_obstacle = -1;     ///< its id
    bool guided = false;           ///< follows a way of foresight
    Vector tool_position_m{};
    Vector tool_velocity_mps{};
  };
  /// One cycle, with the arm as it is at now_s.
  Result step(const ArmState& arm, double now_s);
  /// One cycle without a new arm state. Some are bridged, then the arm brakes.
  Result step(double now_s);

  /// From now on every step brakes; at rest the arm stays.
  void stop();

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace sidestep
