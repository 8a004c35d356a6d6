"""An arm with its collision meshes, judged by Pinocchio and Coal."""
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from kinematics import ROBOTS, chain, configuration, pose

OVERLAP_SHARE = 0.5  # of SAMPLES; links that touch in more do so by design
SAMPLES = 300


class Robot(NamedTuple):
    """A URDF file and the chain's first and last link."""
    urdf: Path
    base: str
    tip: str


ARMS = {
    "panda": Robot(ROBOTS / "panda_description/urdf/panda.urdf", "panda_link0", "panda_hand_tcp"),
    "ur5": Robot(ROBOTS / "ur_description/urdf/ur5_robot.urdf", "base_link", "ee_link"),
    "ur10": Robot(ROBOTS / "ur_description/urdf/ur10_robot.urdf", "base_link", "ee_link"),
    "xarm7": Robot(ROBOTS / "xarm_description/urdf/xarm7.urdf", "link_base", "link_eef"),
    "kinova": Robot(ROBOTS / "kinova_description/robots/kinova.urdf", "j2s6s200_link_base", "j2s6s200_end_effector"),
    "tiago": Robot(ROBOTS / "tiago_description/robots/tiago.urdf", "base_footprint", "arm_tool_link"),  # with its lift
}


class MeshArm:
    """Joint positions are those of the chain from base to tip; joints that are no part of it rest at 0.

    Judged are all pairs of links, except those moved by the same joints or by successive ones, and those that overlap
    by design.
    """

    def __init__(self, robot):
        self.robot = robot
        self.model = pin.buildModelFromUrdf(str(robot.urdf))
        self.data = self.model.createData()
        self.joints = chain(self.model, robot.base, robot.tip)
        self.geometry = pin.buildGeomFromUrdf(self.model, str(robot.urdf), pin.GeometryType.COLLISION,
                                              package_dirs=[str(ROBOTS.parents[1])])
        limits = [self.limits(self.model.joints[joint]) for joint in self.joints]
        self.lower, self.upper = np.array(limits).T
        pairs = self.pairs()
        self.judge(pairs)
        touching = {}
        random = np.random.default_rng(1)
        for _ in range(SAMPLES):
            for links in {self.links(i) for i in self.touching(random.uniform(self.lower, self.upper))}:
                touching[links] = touching.get(links, 0) + 1
        self.overlaps = {links for links, count in touching.items() if count > OVERLAP_SHARE * SAMPLES}
        self.judge([pair for i, pair in enumerate(pairs) if self.links(i) not in self.overlaps])

    def limits(self, joint):
        """Those of the URDF; of a joint that turns farther, one turn."""
        if joint.nq == 2:
            return -np.pi, np.pi
        return (max(self.model.lowerPositionLimit[joint.idx_q], -2 * np.pi),
                min(self.model.upperPositionLimit[joint.idx_q], 2 * np.pi))

    def pairs(self):
        shapes = self.geometry.geometryObjects
        moved_by = [sum(joint in self.model.supports[shape.parentJoint] for joint in self.joints) for shape in shapes]
        return [(a, b) for b in range(len(shapes)) for a in range(b) if abs(moved_by[a] - moved_by[b]) > 1]

    def judge(self, pairs):
        self.geometry.removeAllCollisionPairs()
        for pair in pairs:
            self.geometry.addCollisionPair(pin.CollisionPair(*pair))
        self.results = self.geometry.createData()

    def links(self, i):
        """The names of the two links of pair i."""
        pair, shapes = self.geometry.collisionPairs[i], self.geometry.geometryObjects
        return tuple(sorted(self.model.frames[shapes[shape].parentFrame].name for shape in (pair.first, pair.second)))

    def configuration(self, positions):
        return configuration(self.model, self.joints, positions)

    def touching(self, positions):
        """The indices of all pairs that touch."""
        pin.computeCollisions(self.model, self.data, self.geometry, self.results, self.configuration(positions), False)
        return [i for i, result in enumerate(self.results.collisionResults) if result.isCollision()]

    def is_free(self, positions):
        return not pin.computeCollisions(self.model, self.data, self.geometry, self.results,
                                         self.configuration(positions), True)

    def distance_m(self, positions):
        pin.computeDistances(self.model, self.data, self.geometry, self.results, self.configuration(positions))
        return min((result.min_distance for result in self.results.distanceResults), default=np.inf)

    def tool_m(self, positions):
        """In the frame of the base, m."""
        return pose(self.model, self.data, self.robot.base, self.robot.tip,
                    self.configuration(positions)).translation.copy()
