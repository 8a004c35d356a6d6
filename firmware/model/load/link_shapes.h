#pragma once

#include <urdf_model/model.h>

#include <set>
#include <string>
#include <vector>

#include "firmware/model/load/load_arm.h"

namespace sidestep {

/// A URDF pose, parent_from_child, with its quaternion normalised.
Eigen::Isometry3d to_eigen(const urdf::Pose& pose);

/// What a link is fixed to: a body of the arm, or the frame of a joint outside the chain on this body.
struct Mount {
  int body = 0;
  int other_joint = -1;    ///< -1: the body itself
  bool below_arm = false;  ///< as in LinkShape
};

class OtherJointCollector;

/// Collects the shapes of an arm, body by body: of a link of the chain and of all links attached to it.
class ShapeCollector {
 public:
  /// Appends to `shapes` and `remarks`. All arguments but chain_links must outlive the collector.
  ShapeCollector(const std::string& urdf_file, const std::vector<std::string>& chain_links, const MeshOptions& meshes,
                 OtherJointCollector& others, std::vector<LinkShape>& shapes, std::vector<std::string>& remarks)
      : file_(urdf_file),
        chain_links_(chain_links.begin(), chain_links.end()),
        meshes_(meshes),
        others_(others),
        shapes_(shapes),
        remarks_(remarks) {}

  /// Collects the shapes of a link of the chain and of the side branches below it. Throws std::runtime_error, one line
  /// that names the file and the link.
  void collect(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link);

  /// Collects, as shapes of body 0 and `below_arm`, the links that carry the base link, up to the root of the URDF, and
  /// their other branches. What is behind a joint without a position is left out. Throws as collect().
  void collect_below(const urdf::Link& base);

 private:
  void collect_branch(const urdf::Link& link, const urdf::Link* except, const Mount& mount,
                      const Eigen::Isometry3d& mount_from_link);
  void add_shapes_of(const urdf::Link& link, const Mount& mount, const Eigen::Isometry3d& mount_from_link);
  std::vector<LinkShape> shapes_of(const urdf::Link& link, const urdf::Collision& collision) const;
  std::vector<LinkShape> mesh_shapes(const urdf::Link& link, const urdf::Mesh& mesh) const;
  void remark_on(const urdf::Link& link);
  void add(const LinkShape& shape);

  const std::string& file_;
  std::set<std::string> chain_links_;
  const MeshOptions& meshes_;
  OtherJointCollector& others_;
  std::vector<LinkShape>& shapes_;
  std::vector<std::string>& remarks_;
};

}  // namespace sidestep
