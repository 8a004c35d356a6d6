#pragma once

#include <urdf_model/model.h>

#include <set>
#include <string>
#include <vector>

#include "firmware/model/load/capsule_fit.h"
#include "firmware/model/load/load_arm.h"

namespace sidestep {

/// A URDF pose, parent_from_child, with its quaternion normalised.
Eigen::Isometry3d to_eigen(const urdf::Pose& pose);

/// Collects the shapes of an arm, body by body: of a link of the chain and of all links attached to it.
class ShapeCollector {
 public:
  /// Appends to `shapes` and `remarks`. All arguments but chain_links must outlive the collector.
  ShapeCollector(const std::string& urdf_file, const std::vector<std::string>& chain_links, const MeshOptions& meshes,
                 std::vector<LinkShape>& shapes, std::vector<std::string>& remarks)
      : file_(urdf_file),
        chain_links_(chain_links.begin(), chain_links.end()),
        meshes_(meshes),
        shapes_(shapes),
        remarks_(remarks) {}

  /// Collects the shapes of a link of the chain and of the side branches below it, with their joints at zero. Throws
  /// std::runtime_error, one line that names the file and the link.
  void collect(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link);

  /// Collects, as shapes of body 0 and `below_arm`, the links that the base link is fixed to and the links fixed to
  /// those. Links on movable joints there, such as another arm, are skipped. Throws as collect().
  void collect_below(const urdf::Link& base);

 private:
  void collect_fixed(const urdf::Link& link, const urdf::Link* except, const Eigen::Isometry3d& base_from_link);
  void add_shapes_of(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link, bool below_arm);
  CapsuleFit enclose(const urdf::Link& link, const urdf::Geometry& geometry, bool below_arm) const;
  CapsuleFit enclose_mesh(const urdf::Link& link, const urdf::Mesh& mesh) const;
  void remark_on(const urdf::Link& link);
  void add(const LinkShape& shape);

  const std::string& file_;
  std::set<std::string> chain_links_;
  const MeshOptions& meshes_;
  std::vector<LinkShape>& shapes_;
  std::vector<std::string>& remarks_;
};

}  // namespace sidestep
