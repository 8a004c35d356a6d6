#pragma once

#include <urdf_model/model.h>

#include <set>
#include <string>
#include <vector>

#include "firmware/model/arm.h"
#include "firmware/model/load/capsule_fit.h"

namespace sidestep {

Eigen::Isometry3d to_eigen(const urdf::Pose& pose);

/// Walks from one link of the chain through everything that is fixed to it and collects the shapes.
class ShapeCollector {
 public:
  /// Adds to `shapes` and to `remarks`; the references must outlive the collector.
  ShapeCollector(const std::string& urdf_file, const std::vector<std::string>& chain_links, const MeshOptions& meshes,
                 std::vector<LinkShape>& shapes, std::vector<std::string>& remarks)
      : file_(urdf_file),
        chain_links_(chain_links.begin(), chain_links.end()),
        meshes_(meshes),
        shapes_(shapes),
        remarks_(remarks) {}

  /// Throws std::runtime_error, one line naming the file and the link.
  void collect(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link);

  /// What the base link is fixed to, and what else is fixed to that; what moves there, as another arm, is not ours.
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
